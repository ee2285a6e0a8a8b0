#pragma once

#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "services/demonstration/core/recognition/classifier.hpp"
#include "services/demonstration/tools/training/trainer.hpp"

namespace prehend::demonstration {

/// Takes with what training asks of them again and again.
struct Material {
  std::vector<const Take*> takes;
  std::vector<std::string> classes;  // by name
  Eigen::VectorXi truths;            // of the takes
  std::vector<int> folds;            // of the takes; of one person all alike
  int fold_count = 0;
};

/// Fails on fewer than two people or kinds of grasps.
Expected<Material> material_of(const std::vector<const Take*>& takes, int folds);

/// A classifier of all takes, and what classifiers that did not know a take's person said of it.
struct Trained {
  Classifier classifier;
  Eigen::MatrixXd unseen_scores;  // a column a take
};

Expected<Trained> train_networks(const Material& material, Inputs inputs,
                                 const TrainerOptions& options);

/// States and floor are those that tell people who were left out best.
Expected<Trained> train_hmms(const Material& material, Inputs inputs);

/// What a classifier says of a whole take.
Eigen::VectorXd scores_of(const Classifier& classifier, const Take& take, std::size_t classes);

/// Mean −log p(truth) of scores at their best temperature.
double best_loss(const Eigen::MatrixXd& scores, const Eigen::VectorXi& truths);

}  // namespace prehend::demonstration
