#include "object_models.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <prehend/base/random.hpp>

namespace prehend::recognition {
namespace {

constexpr double sharpness = 6.0;  // of the kernel
constexpr double ridge = 0.02;

/// Solves for the classifier over the views whose `use` is set; rows of the others stay zero.
Eigen::MatrixXf solve_ridge(const Eigen::MatrixXf& kernel, const std::vector<int>& view_class,
                            int classes, const std::vector<char>& use) {
  std::vector<Eigen::Index> kept;
  for (std::size_t i = 0; i < use.size(); ++i)
    if (use[i]) kept.push_back(static_cast<Eigen::Index>(i));
  const auto n = static_cast<Eigen::Index>(kept.size());
  Eigen::MatrixXd K = kernel(kept, kept).cast<double>();
  K.diagonal().array() += ridge;
  Eigen::MatrixXd targets = Eigen::MatrixXd::Zero(n, classes);
  for (Eigen::Index i = 0; i < n; ++i)
    targets(i, view_class[static_cast<std::size_t>(kept[static_cast<std::size_t>(i)])]) = 1;
  const Eigen::MatrixXd solved = K.llt().solve(targets);
  Eigen::MatrixXf dual = Eigen::MatrixXf::Zero(kernel.rows(), classes);
  for (Eigen::Index i = 0; i < n; ++i)
    dual.row(kept[static_cast<std::size_t>(i)]) = solved.row(i).cast<float>();
  return dual;
}

struct Features {
  double score = 0, margin = 0, similarity = 0;
  int best = -1;
};

Features features(const Eigen::VectorXf& scores, const Eigen::VectorXf& similarity) {
  Features made;
  if (scores.size() == 0) return made;
  Eigen::Index best;
  made.score = scores.maxCoeff(&best);
  made.best = static_cast<int>(best);
  double second = 0;  // a class that is nowhere near scores about nothing
  for (Eigen::Index i = 0; i < scores.size(); ++i)
    if (i != best) second = std::max<double>(second, scores[i]);
  made.margin = made.score - second;
  made.similarity = similarity[best];
  return made;
}

/// Logistic regression by Newton's method with a small ridge.
Calibration fit(const std::vector<Eigen::Vector4d>& x, const std::vector<double>& right,
                const std::vector<double>& weight) {
  Calibration made;
  for (int iteration = 0; iteration < 30; ++iteration) {
    Eigen::Vector4d gradient = -0.05 * made.w;
    Eigen::Matrix4d hessian = 0.05 * Eigen::Matrix4d::Identity();
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double p = 1 / (1 + std::exp(-made.w.dot(x[i])));
      gradient += weight[i] * (right[i] - p) * x[i];
      hessian += weight[i] * std::max(1e-6, p * (1 - p)) * x[i] * x[i].transpose();
    }
    const Eigen::Vector4d step = hessian.ldlt().solve(gradient);
    made.w += step.norm() > 5 ? Eigen::Vector4d(5 * step.normalized()) : step;
    if (step.norm() < 1e-6) break;
  }
  return made;
}

/// Measures what the classifier says of views it has not seen: in five folds of neighbouring shots,
/// and, as strangers, of every class when it was left out.
Calibration calibrate(const Eigen::MatrixXf& gram, const Eigen::MatrixXf& kernel,
                      const std::vector<int>& view_class, int classes) {
  const std::size_t n = view_class.size();
  std::vector<int> fold(n);
  std::vector<std::size_t> count(static_cast<std::size_t>(classes), 0), seen = count;
  for (const int c : view_class) ++count[static_cast<std::size_t>(c)];
  for (std::size_t i = 0; i < n; ++i) {
    const auto c = static_cast<std::size_t>(view_class[i]);
    fold[i] = static_cast<int>(5 * seen[c]++ / count[c]);
  }
  std::vector<Eigen::Vector4d> x;
  std::vector<double> right, weight;
  const auto collect = [&](auto held_out, bool stranger, double share) {
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
        if (use[j])
          similarity[view_class[j]] =
              std::max(similarity[view_class[j]], gram(row, static_cast<Eigen::Index>(j)));
      const Features f = features(scores, similarity);
      x.push_back({1, f.score, f.margin, f.similarity});
      right.push_back(!stranger && f.best == view_class[i] ? 1 : 0);
      weight.push_back(share);
    }
  };
  for (int k = 0; k < 5; ++k) collect([&](std::size_t i) { return fold[i] == k; }, false, 1.0);
  for (int c = 0; classes > 1 && c < classes; ++c)
    collect([&](std::size_t i) { return view_class[i] == c; }, true, 0.5);
  return fit(x, right, weight);
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
    const Eigen::MatrixXf nearness = columns(Eigen::all, chosen).transpose() * columns;
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

}  // namespace

double Calibration::probability(double score, double margin, double similarity) const {
  return 1 / (1 + std::exp(-w.dot(Eigen::Vector4d(1, score, margin, similarity))));
}

Eigen::VectorXf descriptor(const Eigen::VectorXf& counts, const Eigen::VectorXf& idf) {
  const float sum = counts.sum();
  if (!(sum > 0)) return Eigen::VectorXf::Zero(counts.size());
  Eigen::VectorXf made = (counts / sum).cwiseSqrt().cwiseProduct(idf);
  const float norm = made.norm();
  return norm > 0 ? Eigen::VectorXf(made / norm) : Eigen::VectorXf::Zero(counts.size());
}

Plane centred_mask(int width, int height) {
  Plane made(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double u = (x + 0.5) / width - 0.5, v = (y + 0.5) / height - 0.5;
      made.at(x, y) = u * u + v * v < 0.36 * 0.36;
    }
  return made;
}

Eigen::VectorXf describe(const ObjectModels& models, const Plane& colours, const Plane& mask) {
  return descriptor(
      cooccurrence(colours, models.palette.size(), offsets_at(models.distances), mask), models.idf);
}

Expected<ObjectModels> train(const std::vector<TrainingClass>& classes,
                             const DescriptorOptions& options, int max_views) {
  struct Item {
    const TrainingView* view;
    int label;
  };
  std::vector<Item> items;
  std::vector<ObjectClass> learned;
  for (const TrainingClass& given : classes) {
    std::vector<const TrainingView*> usable;
    for (const TrainingView& view : given.views)
      if (!view.picture.empty() && view.mask.width == view.picture.width &&
          view.mask.height == view.picture.height &&
          std::any_of(view.mask.values.begin(), view.mask.values.end(),
                      [](std::uint8_t v) { return v != 0; }))
        usable.push_back(&view);
    if (usable.empty()) continue;
    const auto keep = std::min(usable.size(), static_cast<std::size_t>(std::max(1, max_views)));
    for (std::size_t i = 0; i < keep; ++i)
      items.push_back({usable[i * usable.size() / keep], static_cast<int>(learned.size())});
    learned.push_back({given.name, {}, {}});
  }
  if (items.empty())
    return fail("no usable view", "training", "give a folder with a folder of pictures a class");
  const int class_count = static_cast<int>(learned.size());

  // The palette: as many pixels of every view.
  Random random(options.seed);
  std::vector<Eigen::Vector3f> samples;
  const std::size_t a_view = std::clamp<std::size_t>(24000 / items.size(), 8, 400);
  for (const Item& item : items) {
    const Picture& picture = item.view->picture;
    for (std::size_t i = 0, tries = 0; i < a_view && tries < 40 * a_view; ++tries) {
      const std::size_t p = random.index(picture.pixels());
      if (!item.view->mask.values[p]) continue;
      samples.push_back(colour_feature(options.space, picture.rgb[3 * p], picture.rgb[3 * p + 1],
                                       picture.rgb[3 * p + 2]));
      ++i;
    }
  }
  ObjectModels made{Palette::learn(options.space, samples, options.colours, options.seed),
                    {},
                    0,
                    options.distances,
                    {},
                    {},
                    {},
                    {},
                    {},
                    sharpness,
                    {}};
  const int colours = made.palette.size();
  const auto n = static_cast<Eigen::Index>(items.size());
  const std::vector<Offset> offsets = offsets_at(options.distances);

  Eigen::MatrixXf counts(pair_count(colours), n);
  Eigen::VectorXf use = Eigen::VectorXf::Zero(colours);
  for (ObjectClass& c : learned) c.colours = Eigen::VectorXf::Zero(colours);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Item& item = items[static_cast<std::size_t>(i)];
    const Plane quantised = made.palette.quantise(item.view->picture);
    counts.col(i) = cooccurrence(quantised, colours, offsets, item.view->mask);
    made.view_class.push_back(item.label);
    Eigen::VectorXf share = Eigen::VectorXf::Zero(colours);
    for (std::size_t p = 0; p < quantised.values.size(); ++p)
      if (item.view->mask.values[p]) share[quantised.values[p]] += 1;
    share /= share.sum();
    learned[static_cast<std::size_t>(item.label)].colours += share;
    use += share;
  }
  for (ObjectClass& c : learned) c.colours /= c.colours.sum();
  use /= use.sum();

  // Rarity: a pair of colours that every view has tells little.
  made.idf.resize(counts.rows());
  for (Eigen::Index b = 0; b < counts.rows(); ++b) {
    int views_with = 0;
    for (Eigen::Index i = 0; i < n; ++i)
      if (counts(b, i) > 2e-4f * counts.col(i).sum()) ++views_with;
    made.idf[b] =
        std::sqrt(std::log((2.f + static_cast<float>(n)) / (1.f + static_cast<float>(views_with))));
  }
  made.views.resize(counts.rows(), n);
  for (Eigen::Index i = 0; i < n; ++i) made.views.col(i) = descriptor(counts.col(i), made.idf);

  const Eigen::MatrixXf gram = made.views.transpose() * made.views;
  const Eigen::MatrixXf kernel =
      ((gram.array() - 1) * static_cast<float>(sharpness)).exp().matrix();
  made.dual = solve_ridge(kernel, made.view_class, class_count, std::vector<char>(items.size(), 1));
  made.calibration = calibrate(gram, kernel, made.view_class, class_count);

  made.coarse =
      merge_colours(made.palette, use, options.coarse_colours, options.seed, made.coarse_colours);
  for (int c = 0; c < class_count; ++c) {
    std::vector<Eigen::VectorXf> columns;
    for (Eigen::Index i = 0; i < n; ++i)
      if (made.view_class[static_cast<std::size_t>(i)] == c && counts.col(i).sum() > 0)
        columns.push_back(
            fold_counts(counts.col(i), made.coarse, made.coarse_colours).cwiseSqrt().normalized());
    if (columns.empty()) columns.push_back(Eigen::VectorXf::Zero(pair_count(made.coarse_colours)));
    Eigen::MatrixXf together(columns.front().size(), static_cast<Eigen::Index>(columns.size()));
    for (std::size_t i = 0; i < columns.size(); ++i)
      together.col(static_cast<Eigen::Index>(i)) = columns[i];
    learned[static_cast<std::size_t>(c)].prototypes = prototypes(together, options.views_a_class);
  }
  made.classes = std::move(learned);
  return made;
}

Classification classify(const ObjectModels& models, const Eigen::VectorXf& d, bool learned) {
  Classification made;
  const auto classes = static_cast<Eigen::Index>(models.classes.size());
  made.similarity = Eigen::VectorXf::Zero(classes);
  made.scores = Eigen::VectorXf::Zero(classes);
  if (classes == 0 || d.size() != models.views.rows() || !(d.norm() > 0)) return made;
  const Eigen::VectorXf near = models.views.transpose() * d;
  for (Eigen::Index i = 0; i < near.size(); ++i) {
    float& best = made.similarity[models.view_class[static_cast<std::size_t>(i)]];
    best = std::max(best, near[i]);
  }
  const Eigen::VectorXf kernel =
      ((near.array() - 1) * static_cast<float>(models.kernel_sharpness)).exp();
  made.scores = models.dual.transpose() * kernel;
  const Features f = features(made.scores, made.similarity);
  made.best = f.best;
  made.probability = models.calibration.probability(f.score, f.margin, f.similarity);
  if (!learned) {
    made.scores = made.similarity;
    Eigen::Index best;
    made.similarity.maxCoeff(&best);
    // The calibration speaks of the learned classifier; where they differ neither is to be trusted.
    if (made.best != static_cast<int>(best)) made.probability *= 0.5;
    made.best = static_cast<int>(best);
  }
  return made;
}

Expected<void> ObjectModels::check() const {
  const auto wrong = [](const char* what) {
    return fail(what, "object models", "train again: prehend objects train");
  };
  const int colours = palette.size();
  if (colours < 1 || colours > Palette::max_colours) return wrong("palette has a wrong size");
  for (const auto& centre : palette.centres())
    if (!centre.allFinite()) return wrong("palette is not finite");
  if (coarse_colours < 1 || coarse_colours > colours) return wrong("coarse palette is wrong");
  if (static_cast<int>(coarse.size()) != colours) return wrong("coarse palette has a wrong size");
  for (const int c : coarse)
    if (c < 0 || c >= coarse_colours) return wrong("coarse colour out of range");
  if (distances.empty() || distances.size() > 16) return wrong("offsets are wrong");
  for (const int d : distances)
    if (d < 1 || d > 64) return wrong("an offset is out of range");
  if (idf.size() != pair_count(colours) || !idf.allFinite()) return wrong("weights are wrong");
  if (classes.empty() || classes.size() > 1000) return wrong("number of classes is wrong");
  for (const ObjectClass& c : classes) {
    if (c.name.empty() || c.name.size() > 64) return wrong("a class has no proper name");
    if (c.colours.size() != colours || !c.colours.allFinite()) return wrong("colours are wrong");
    if (c.prototypes.rows() != pair_count(coarse_colours) || c.prototypes.cols() < 1 ||
        !c.prototypes.allFinite())
      return wrong("prototypes are wrong");
  }
  if (views.cols() < 1 || views.rows() != pair_count(colours) || !views.allFinite())
    return wrong("views are wrong");
  if (static_cast<Eigen::Index>(view_class.size()) != views.cols())
    return wrong("labels of views are wrong");
  for (const int c : view_class)
    if (c < 0 || c >= static_cast<int>(classes.size())) return wrong("a label is out of range");
  if (dual.rows() != views.cols() || dual.cols() != static_cast<Eigen::Index>(classes.size()) ||
      !dual.allFinite())
    return wrong("classifier is wrong");
  if (!std::isfinite(kernel_sharpness) || kernel_sharpness <= 0 || kernel_sharpness > 1000)
    return wrong("kernel is wrong");
  if (!calibration.w.allFinite()) return wrong("calibration is not finite");
  return {};
}

}  // namespace prehend::recognition
