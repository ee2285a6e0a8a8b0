#include "services/recognition/core/learning/object_models.hpp"

#include <algorithm>
#include <cmath>

#include "services/recognition/core/learning/ridge.hpp"

namespace prehend::recognition {

DescriptorOptions photos_of_objects() {
  DescriptorOptions made;
  made.space.brightness_weight = 0.05;
  made.space.constancy = Constancy::grey_world;
  made.varied = 2;
  made.parts = 0;
  return made;
}

Eigen::VectorXf descriptor(const Eigen::VectorXf& counts, const Eigen::VectorXf& idf,
                           Weighting weighting) {
  const float sum = counts.sum();
  if (!(sum > 0)) return Eigen::VectorXf::Zero(counts.size());
  if (weighting == Weighting::intersection) return counts / sum;
  Eigen::VectorXf made = (counts / sum).cwiseSqrt();
  if (weighting == Weighting::idf_hellinger) made = made.cwiseProduct(idf).eval();
  const float norm = made.norm();
  return norm > 0 ? Eigen::VectorXf(made / norm) : Eigen::VectorXf::Zero(counts.size());
}

Eigen::MatrixXf similarities(const Eigen::MatrixXf& views, const Eigen::MatrixXf& others,
                             Weighting weighting) {
  if (weighting != Weighting::intersection) return views.transpose() * others;
  Eigen::MatrixXf made(views.cols(), others.cols());
  for (Eigen::Index j = 0; j < others.cols(); ++j)
    for (Eigen::Index i = 0; i < views.cols(); ++i)
      made(i, j) = views.col(i).cwiseMin(others.col(j)).sum();
  return made;
}

Plane centred_mask(int width, int height) {
  Plane made(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double u = (x + 0.5) / width - 0.5, v = (y + 0.5) / height - 0.5;
      made.at(x, y) = u * u / (0.3 * 0.3) + v * v / (0.43 * 0.43) < 1;
    }
  return made;
}

Eigen::VectorXf describe(const ObjectModels& models, const Plane& colours, const Plane& mask) {
  const int size = models.palette.size();
  Eigen::VectorXf counts = cooccurrence(colours, size, offsets_at(models.distances), mask);
  for (int k = 0; k < size; ++k) counts[pair_index(k, k)] *= static_cast<float>(models.same_pairs);
  return descriptor(counts, models.idf, models.weighting);
}

Classification classify(const ObjectModels& models, const Eigen::VectorXf& d, bool learned) {
  Classification made;
  const auto classes = static_cast<Eigen::Index>(models.classes.size());
  made.similarity = Eigen::VectorXf::Zero(classes);
  made.scores = Eigen::VectorXf::Zero(classes);
  if (classes == 0 || d.size() != models.views.rows() || !(d.norm() > 0)) return made;
  const Eigen::VectorXf near = similarities(models.views, d, models.weighting);
  for (Eigen::Index i = 0; i < near.size(); ++i) {
    const int c = models.view_class[static_cast<std::size_t>(i)];
    if (c >= 0) made.similarity[c] = std::max(made.similarity[c], near[i]);
  }
  made.scores = models.dual.transpose() * kernel_of(near, models.kernel_sharpness);
  // A damaged model may hold numbers so large that nothing is left of an answer.
  if (!made.scores.allFinite() || !made.similarity.allFinite()) {
    made.scores.setZero();
    made.similarity.setZero();
    return made;
  }
  const Grounds seen = grounds(made.scores, made.similarity);
  made.best = seen.best;
  made.probability = models.calibration.probability(seen);
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
    if (d < 0 || d > 64) return wrong("an offset is out of range");
  if (!(same_pairs >= 0 && same_pairs <= 1)) return wrong("weight of pairs of one colour is wrong");
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
    if (c < -1 || c >= static_cast<int>(classes.size())) return wrong("a label is out of range");
  if (view_fold.size() != view_class.size()) return wrong("folds of views are wrong");
  for (const int f : view_fold)
    if (f < 0 || f >= calibration_folds) return wrong("a fold is out of range");
  if (dual.rows() != views.cols() || dual.cols() != static_cast<Eigen::Index>(classes.size()) ||
      !dual.allFinite())
    return wrong("classifier is wrong");
  if (!std::isfinite(kernel_sharpness) || kernel_sharpness <= 0 || kernel_sharpness > 1000)
    return wrong("kernel is wrong");
  if (!calibration.w.allFinite()) return wrong("calibration is not finite");
  return {};
}

}  // namespace prehend::recognition
