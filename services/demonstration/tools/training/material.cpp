#include "services/demonstration/tools/training/material.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace prehend::demonstration {

Expected<Material> material_of(const std::vector<const Take*>& takes, int folds) {
  Material made{takes, {}, Eigen::VectorXi(static_cast<Eigen::Index>(takes.size())), {}, 0};
  std::set<std::string> labels;
  std::map<std::string, int> fold_of;
  for (const Take* take : takes) {
    labels.insert(take->label);
    fold_of[take->user] = 0;
  }
  if (fold_of.size() < 2)
    return fail("fewer than two people to learn from", {}, "take more people");
  if (labels.size() < 2)
    return fail("fewer than two kinds of grasps to learn", {}, "take more kinds");
  made.classes.assign(labels.begin(), labels.end());
  made.fold_count = std::min(std::max(2, folds), static_cast<int>(fold_of.size()));
  int next = 0;
  for (auto& [user, fold] : fold_of) fold = next++ % made.fold_count;
  for (std::size_t i = 0; i < takes.size(); ++i) {
    const auto found = std::lower_bound(made.classes.begin(), made.classes.end(), takes[i]->label);
    made.truths[static_cast<Eigen::Index>(i)] = static_cast<int>(found - made.classes.begin());
    made.folds.push_back(fold_of.at(takes[i]->user));
  }
  return made;
}

Eigen::VectorXd scores_of(const Classifier& classifier, const Take& take, std::size_t classes) {
  ClassifierStream stream(classifier);
  Eigen::VectorXd scores = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(classes));
  for (const HandSample& sample : take.samples) scores = stream.add(sample);
  return scores;
}

double best_loss(const Eigen::MatrixXd& scores, const Eigen::VectorXi& truths) {
  const double temperature = calibrated_temperature(scores, truths);
  double sum = 0;
  for (Eigen::Index i = 0; i < scores.cols(); ++i)
    sum -= std::log(distribution_of(scores.col(i), temperature)[truths[i]] + 1e-300);
  return sum / static_cast<double>(std::max<Eigen::Index>(1, scores.cols()));
}

}  // namespace prehend::demonstration
