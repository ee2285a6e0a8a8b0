#pragma once

#include <Eigen/Core>
#include <optional>
#include <variant>
#include <vector>

#include "common/learning/network.hpp"
#include "services/demonstration/core/recognition/features.hpp"
#include "services/demonstration/core/recognition/gaussian_hmm.hpp"
#include "services/demonstration/core/recognition/whitening.hpp"

namespace prehend::demonstration {

/// Networks that see the summary of a grasp so far and answer with a number a class. Their
/// answers are averaged as log odds.
struct NetworkClassifier {
  Inputs inputs{};
  Whitening scale;
  std::vector<learning::Network> networks;
};

/// A hidden Markov model a class, of the features after each other.
struct HmmClassifier {
  Inputs inputs{};
  Whitening scale;
  std::vector<GaussianHmm> models;
};

using Classifier = std::variant<NetworkClassifier, HmmClassifier>;

/// Refuses parts that do not fit each other or this number of classes.
Expected<void> check(const Classifier& classifier, std::size_t classes);

/// What a classifier says while a grasp goes on. Keeps a reference to the classifier.
class ClassifierStream {
 public:
  explicit ClassifierStream(const Classifier& classifier);
  /// Scores of the classes after all samples so far: logarithms but for a common summand and
  /// factor.
  Eigen::VectorXd add(const HandSample& sample);

 private:
  struct NetworkState {
    const NetworkClassifier* classifier;
    Summary summary;
  };
  struct HmmState {
    const HmmClassifier* classifier;
    FeatureStream features;
    std::vector<GaussianHmm::Forward> forwards;
    int count = 0;
  };
  static Eigen::VectorXd add(NetworkState& state, const HandSample& sample);
  static Eigen::VectorXd add(HmmState& state, const HandSample& sample);

  std::variant<NetworkState, HmmState> state_;
};

}  // namespace prehend::demonstration
