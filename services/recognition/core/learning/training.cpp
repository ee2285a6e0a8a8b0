#include "services/recognition/core/learning/training.hpp"

#include <algorithm>
#include <cmath>

#include "services/recognition/core/learning/folds.hpp"
#include "services/recognition/core/learning/ridge.hpp"

namespace prehend::recognition {
namespace {

constexpr double sharpness = 6.0;  // of the kernel

/// Measures what the classifier says of views it has not seen: in folds by background and, as
/// strangers, of other things in their folds and of every class when it was left out. Varied views
/// are judged, too, because another day is what the answer is for.
Calibration calibrate(const ObjectModels& models, const Eigen::MatrixXf& near,
                      const Eigen::MatrixXf& kernel) {
  const std::vector<int>& view_class = models.view_class;
  const int classes = static_cast<int>(models.classes.size());
  const std::size_t n = view_class.size();
  std::vector<Outcome> outcomes;
  const auto collect = [&](auto held_out, bool stranger, double weight) {
    std::vector<char> use(n);
    for (std::size_t i = 0; i < n; ++i) use[i] = !held_out(i);
    if (std::none_of(use.begin(), use.end(), [](char u) { return u != 0; })) return;
    const Eigen::MatrixXf dual = solve_ridge(kernel, view_class, classes, use);
    for (std::size_t i = 0; i < n; ++i) {
      if (use[i]) continue;
      const auto row = static_cast<Eigen::Index>(i);
      const Eigen::VectorXf scores = (kernel.row(row) * dual).transpose();
      Eigen::VectorXf similarity = Eigen::VectorXf::Zero(classes);
      for (std::size_t j = 0; j < n; ++j)
        if (use[j] && view_class[j] >= 0)
          similarity[view_class[j]] =
              std::max(similarity[view_class[j]], near(row, static_cast<Eigen::Index>(j)));
      const Grounds seen = grounds(scores, similarity);
      outcomes.push_back({seen, !stranger && seen.best == view_class[i], weight});
    }
  };
  for (int k = 0; k < calibration_folds; ++k)
    collect([&](std::size_t i) { return models.view_fold[i] == k; }, false, 1.0);
  for (int c = 0; classes > 1 && c < classes; ++c)
    collect([&](std::size_t i) { return view_class[i] == c; }, true, 0.5);
  return fit(outcomes);
}

/// The classifier over the views, and how sure it is.
void learn_classifier(ObjectModels& models) {
  const Eigen::MatrixXf near = similarities(models.views, models.views, models.weighting);
  const Eigen::MatrixXf kernel = kernel_of(near, models.kernel_sharpness);
  models.dual = solve_ridge(kernel, models.view_class, static_cast<int>(models.classes.size()),
                            std::vector<char>(models.view_class.size(), 1));
  models.calibration = calibrate(models, near, kernel);
}

/// Merges the palette's colours into fewer, by k-means over their centres weighted by use.
std::vector<int> merge_colours(const Palette& palette, const Eigen::VectorXf& use, int colours,
                               std::uint64_t seed, int& made) {
  std::vector<Eigen::Vector3f> samples;
  for (int k = 0; k < palette.size(); ++k)
    for (int i = 0; i < 1 + static_cast<int>(40 * use[k]); ++i)
      samples.push_back(palette.centres()[static_cast<std::size_t>(k)]);
  const Palette coarse = Palette::learn(palette.space(), samples, colours, seed);
  made = coarse.size();
  std::vector<int> map;
  for (const Eigen::Vector3f& centre : palette.centres()) map.push_back(coarse.nearest(centre));
  return map;
}

/// The views of things that are none of the classes, behind those that are there. All views of one
/// thing are of one fold, so that things are judged that the classifier does not know.
void add_others(const std::vector<TrainingClass>& others, const DescriptorOptions& options,
                ObjectModels& models) {
  const int parts = std::min(1, options.parts);
  Eigen::Index column = models.views.cols(), all = column;
  for (const TrainingClass& thing : others)
    all += static_cast<Eigen::Index>(thing.views.size()) * (1 + parts);
  models.views.conservativeResize(Eigen::NoChange, all);
  Random random(options.seed);
  int fold = 0;
  for (const TrainingClass& thing : others) {
    for (const TrainingView& view : thing.views) {
      const Plane quantised = models.palette.quantise(view.picture);
      for (int part = 0; part <= parts; ++part) {
        models.views.col(column++) =
            describe(models, quantised, part == 0 ? view.mask : part_of(view.mask, random));
        models.view_class.push_back(-1);
        models.view_fold.push_back(fold);
      }
    }
    fold = (fold + 1) % calibration_folds;
  }
}

Eigen::VectorXf fold_counts(const Eigen::VectorXf& fine, const std::vector<int>& coarse,
                            int coarse_colours) {
  Eigen::VectorXf made = Eigen::VectorXf::Zero(pair_count(coarse_colours));
  for (int a = 0; a < static_cast<int>(coarse.size()); ++a)
    for (int b = 0; b <= a; ++b)
      made[pair_index(coarse[static_cast<std::size_t>(a)], coarse[static_cast<std::size_t>(b)])] +=
          fine[pair_index(a, b)];
  return made;
}

/// At most `count` directions that stand for the columns: k-means on the unit sphere.
Eigen::MatrixXf prototypes(const Eigen::MatrixXf& columns, int count) {
  std::vector<Eigen::Index> chosen{0};
  while (static_cast<int>(chosen.size()) < std::min<int>(count, static_cast<int>(columns.cols()))) {
    // Not the vector itself: GCC 14 sees a bound passed where Eigen copies it.
    const Eigen::Map<const Eigen::VectorX<Eigen::Index>> so_far(
        chosen.data(), static_cast<Eigen::Index>(chosen.size()));
    const Eigen::MatrixXf nearness = columns(Eigen::all, so_far).transpose() * columns;
    Eigen::Index furthest;
    if (nearness.colwise().maxCoeff().minCoeff(&furthest) > 0.9999f) break;
    chosen.push_back(furthest);
  }
  Eigen::MatrixXf centres = columns(Eigen::all, chosen);
  for (int iteration = 0; iteration < 8; ++iteration) {
    const Eigen::MatrixXf nearness = centres.transpose() * columns;
    Eigen::MatrixXf sums = Eigen::MatrixXf::Zero(centres.rows(), centres.cols());
    for (Eigen::Index i = 0; i < columns.cols(); ++i) {
      Eigen::Index best;
      nearness.col(i).maxCoeff(&best);
      sums.col(best) += columns.col(i);
    }
    for (Eigen::Index k = 0; k < centres.cols(); ++k)
      if (sums.col(k).norm() > 0) centres.col(k) = sums.col(k).normalized();
  }
  return centres;
}

/// The views that show something, at most `max_views` of a class, evenly chosen; classes that have
/// any.
std::vector<TrainingClass> usable(const std::vector<TrainingClass>& classes, int max_views) {
  std::vector<TrainingClass> made;
  for (const TrainingClass& given : classes) {
    std::vector<const TrainingView*> good;
    for (const TrainingView& view : given.views)
      if (!view.picture.empty() && view.mask.width == view.picture.width &&
          view.mask.height == view.picture.height &&
          std::any_of(view.mask.values.begin(), view.mask.values.end(),
                      [](std::uint8_t v) { return v != 0; }))
        good.push_back(&view);
    if (good.empty()) continue;
    const auto keep = std::min(good.size(), static_cast<std::size_t>(std::max(1, max_views)));
    made.push_back({given.name, {}});
    for (std::size_t i = 0; i < keep; ++i)
      made.back().views.push_back(*good[i * good.size() / keep]);
  }
  return made;
}

/// Colours of as many pixels of every view, about `count` in all.
void sample_colours(const std::vector<TrainingClass>& classes, const ColourSpace& space,
                    std::size_t count, Random& random, std::vector<Eigen::Vector3f>& samples) {
  std::size_t views = 0;
  for (const TrainingClass& c : classes) views += c.views.size();
  const std::size_t a_view =
      std::clamp<std::size_t>(count / std::max<std::size_t>(1, views), 8, 400);
  for (const TrainingClass& c : classes)
    for (const TrainingView& view : c.views) {
      const Picture picture = balanced(view.picture, space.constancy);
      for (std::size_t i = 0, tries = 0; i < a_view && tries < 40 * a_view; ++tries) {
        const std::size_t p = random.index(picture.pixels());
        if (!view.mask.values[p]) continue;
        samples.push_back(colour_feature(space, picture.rgb[3 * p], picture.rgb[3 * p + 1],
                                         picture.rgb[3 * p + 2]));
        ++i;
      }
    }
}

/// Of the classes' views and, in a smaller part, of other things: a palette of nothing but the
/// objects' colours would take any other for one of them.
Palette learn_palette(const std::vector<TrainingClass>& classes,
                      const std::vector<TrainingClass>& others, const DescriptorOptions& options) {
  Random random(options.seed);
  std::vector<Eigen::Vector3f> samples;
  sample_colours(classes, options.space, 24000, random, samples);
  sample_colours(others, options.space, 8000, random, samples);
  return Palette::learn(options.space, samples, options.colours, options.seed);
}

/// Share of each colour under the mask.
Eigen::VectorXf shares(const Plane& colours, const Plane& mask, int size) {
  Eigen::VectorXf made = Eigen::VectorXf::Zero(size);
  for (std::size_t p = 0; p < colours.values.size(); ++p)
    if (mask.values[p]) made[colours.values[p]] += 1;
  return made / made.sum();
}

/// A pair of colours that every view has tells little: sqrt(log((2 + views) / (1 + views with
/// it))).
Eigen::VectorXf rarity(const Eigen::MatrixXf& counts) {
  Eigen::VectorXf made(counts.rows());
  const auto n = static_cast<float>(counts.cols());
  const Eigen::RowVectorXf least = 2e-4f * counts.colwise().sum();
  for (Eigen::Index b = 0; b < counts.rows(); ++b) {
    const auto with = static_cast<float>((counts.row(b).array() > least.array()).count());
    made[b] = std::sqrt(std::log((2.f + n) / (1.f + with)));
  }
  return made;
}

/// Columns that a view becomes: itself, its varied copies, and parts of each.
Eigen::Index columns_a_view(const DescriptorOptions& options) {
  return (1 + Eigen::Index{options.varied}) * (1 + Eigen::Index{options.parts});
}

/// Counts of the pairs of every view and of its copies, as columns. Adds class, fold and colours of
/// each to the models; the classes are new ones behind those that are there.
Eigen::MatrixXf count_pairs(const std::vector<TrainingClass>& classes,
                            const DescriptorOptions& options, ObjectModels& models) {
  const std::vector<int> background = folds_by_background(classes, calibration_folds);
  const int colours = models.palette.size();
  const std::vector<Offset> offsets = offsets_at(models.distances);
  Eigen::MatrixXf counts(pair_count(colours),
                         static_cast<Eigen::Index>(background.size()) * columns_a_view(options));
  Random random(options.seed);
  auto fold = background.begin();
  Eigen::Index column = 0;
  for (const TrainingClass& c : classes) {
    ObjectClass learned{c.name, Eigen::VectorXf::Zero(colours), {}};
    for (const TrainingView& view : c.views) {
      for (int copy = 0; copy <= options.varied; ++copy) {
        const Plane quantised =
            models.palette.quantise(copy == 0 ? view.picture : varied(view.picture, random));
        learned.colours += shares(quantised, view.mask, colours);
        for (int part = 0; part <= options.parts; ++part) {
          counts.col(column++) = cooccurrence(quantised, colours, offsets,
                                              part == 0 ? view.mask : part_of(view.mask, random));
          models.view_class.push_back(static_cast<int>(models.classes.size()));
          models.view_fold.push_back(*fold);
        }
      }
      ++fold;
    }
    learned.colours /= learned.colours.sum();
    models.classes.push_back(std::move(learned));
  }
  return counts;
}

/// The scan's prototypes of the class, from counts of its views.
Eigen::MatrixXf prototypes_of(const Eigen::MatrixXf& counts, const ObjectModels& models,
                              int max_views) {
  Eigen::MatrixXf columns(pair_count(models.coarse_colours), counts.cols());
  Eigen::Index used = 0;
  for (Eigen::Index i = 0; i < counts.cols(); ++i)
    if (counts.col(i).sum() > 0)
      columns.col(used++) =
          fold_counts(counts.col(i), models.coarse, models.coarse_colours).cwiseSqrt().normalized();
  if (used == 0) return Eigen::MatrixXf::Zero(columns.rows(), 1);
  return prototypes(columns.leftCols(used), max_views);
}

/// Counts as descriptors, in place.
void describe_counts(const ObjectModels& models, Eigen::MatrixXf& counts) {
  for (Eigen::Index i = 0; i < counts.cols(); ++i)
    counts.col(i) = descriptor(counts.col(i), models.idf, models.weighting);
}

void weigh_same_pairs(const ObjectModels& models, Eigen::MatrixXf& counts) {
  for (int k = 0; k < models.palette.size(); ++k)
    counts.row(pair_index(k, k)) *= static_cast<float>(models.same_pairs);
}

}  // namespace

Expected<ObjectModels> train(const std::vector<TrainingClass>& classes,
                             const DescriptorOptions& options, int max_views,
                             const std::vector<TrainingClass>& others) {
  const std::vector<TrainingClass> used = usable(classes, max_views);
  if (used.empty())
    return fail("no usable view", "training", "give a folder with a folder of pictures a class");
  ObjectModels made{.palette = learn_palette(used, usable(others, max_views), options)};
  made.distances = options.distances;
  made.same_pairs = options.same_pairs;
  made.weighting = options.weighting;
  made.kernel_sharpness = sharpness;
  Eigen::MatrixXf counts = count_pairs(used, options, made);

  Eigen::VectorXf use = Eigen::VectorXf::Zero(made.palette.size());
  for (const ObjectClass& c : made.classes) use += c.colours;
  use /= use.sum();
  made.coarse =
      merge_colours(made.palette, use, options.coarse_colours, options.seed, made.coarse_colours);
  Eigen::Index begin = 0;
  for (std::size_t c = 0; c < used.size(); ++c) {
    const auto views = static_cast<Eigen::Index>(used[c].views.size()) * columns_a_view(options);
    made.classes[c].prototypes =
        prototypes_of(counts.middleCols(begin, views), made, options.views_a_class);
    begin += views;
  }
  weigh_same_pairs(made, counts);
  made.idf = rarity(counts);
  describe_counts(made, counts);
  made.views = std::move(counts);
  add_others(usable(others, max_views), options, made);
  learn_classifier(made);
  return made;
}

Expected<ObjectModels> with_class(ObjectModels models, const TrainingClass& added,
                                  const DescriptorOptions& options, int max_views) {
  const std::vector<TrainingClass> used = usable({added}, max_views);
  if (used.empty()) return fail("has no usable view", added.name);
  for (const ObjectClass& c : models.classes)
    if (c.name == added.name)
      return fail("is known already", added.name, "choose another name, or train anew");
  Eigen::MatrixXf counts = count_pairs(used, options, models);
  models.classes.back().prototypes = prototypes_of(counts, models, options.views_a_class);
  weigh_same_pairs(models, counts);
  describe_counts(models, counts);
  Eigen::MatrixXf views(models.views.rows(), models.views.cols() + counts.cols());
  views << models.views, counts;
  models.views = std::move(views);
  learn_classifier(models);
  return models;
}

}  // namespace prehend::recognition
