#include "services/demonstration/core/recognition/classifier.hpp"

#include <algorithm>
#include <cmath>

namespace prehend::demonstration {

namespace {

constexpr double surest_answer = 1 - 1e-9;

Expected<void> check_parts(const NetworkClassifier& classifier, std::size_t classes) {
  if (classifier.networks.empty()) return fail("a classifier has no network");
  if (classifier.scale.inputs() != summary_count(classifier.inputs))
    return fail("a classifier's scale does not fit its inputs");
  for (const learning::Network& network : classifier.networks)
    if (network.inputs() != classifier.scale.outputs() ||
        network.outputs() != static_cast<int>(classes))
      return fail("a network does not fit its inputs or classes");
  return {};
}

Expected<void> check_parts(const HmmClassifier& classifier, std::size_t classes) {
  if (classifier.models.size() != classes)
    return fail("there are not as many hidden Markov models as classes");
  if (classifier.scale.inputs() != feature_count(classifier.inputs))
    return fail("a classifier's scale does not fit its inputs");
  for (const GaussianHmm& model : classifier.models)
    if (model.size() != classifier.scale.outputs())
      return fail("a hidden Markov model does not fit its inputs");
  return {};
}

}  // namespace

Expected<void> check(const Classifier& classifier, std::size_t classes) {
  return std::visit([&](const auto& parts) { return check_parts(parts, classes); }, classifier);
}

ClassifierStream::ClassifierStream(const Classifier& classifier)
    : state_(NetworkState{nullptr, Summary(Inputs::both)}) {
  if (const auto* network = std::get_if<NetworkClassifier>(&classifier)) {
    state_ = NetworkState{network, Summary(network->inputs)};
    return;
  }
  const auto& hmm = std::get<HmmClassifier>(classifier);
  HmmState state{&hmm, FeatureStream(hmm.inputs), {}};
  for (const GaussianHmm& model : hmm.models) state.forwards.emplace_back(model);
  state_ = std::move(state);
}

Eigen::VectorXd ClassifierStream::add(NetworkState& state, const HandSample& sample) {
  const NetworkClassifier& classifier = *state.classifier;
  const Eigen::VectorXd x = classifier.scale.apply(state.summary.add(sample));
  Eigen::VectorXd scores = Eigen::VectorXd::Zero(classifier.networks.front().outputs());
  for (const learning::Network& network : classifier.networks) {
    const Eigen::ArrayXd y = network.evaluate(x).array().min(surest_answer).max(-surest_answer);
    scores.array() += ((1 + y) / (1 - y)).log();
  }
  return scores / static_cast<double>(classifier.networks.size());
}

Eigen::VectorXd ClassifierStream::add(HmmState& state, const HandSample& sample) {
  const Eigen::VectorXd x = state.classifier->scale.apply(state.features.add(sample));
  ++state.count;
  Eigen::VectorXd scores(static_cast<Eigen::Index>(state.forwards.size()));
  // By the length, or what lasts long would be sure for that alone.
  for (std::size_t c = 0; c < state.forwards.size(); ++c)
    scores[static_cast<Eigen::Index>(c)] = state.forwards[c].add(x) / state.count;
  return scores;
}

Eigen::VectorXd ClassifierStream::add(const HandSample& sample) {
  return std::visit([&](auto& state) { return add(state, sample); }, state_);
}

}  // namespace prehend::demonstration
