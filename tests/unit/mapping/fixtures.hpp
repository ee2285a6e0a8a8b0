#pragma once

#include <array>
#include <prehend/base/random.hpp>
#include <prehend/mapping/mapping.hpp>
#include <prehend/mapping/mapping_model.hpp>
#include <prehend/model/human_hand.hpp>
#include <prehend/test_support/hands.hpp>

namespace prehend::mapping {

/// The Barrett hand of the lab.
inline const model::HandModel& barrett() {
  static const model::HandModel& hand = test::hand("barrett");
  return hand;
}

/// The features of a posture of an average hand.
inline Fingertips tips(const std::array<double, model::finger_count>& closure) {
  const auto poses = model::HumanHand(1.0).fingertip_poses(model::HumanHand::posture(closure));
  Fingertips result;
  for (std::size_t f = 0; f < poses.size(); ++f) result[f] = {true, poses[f].translation()};
  return result;
}

/// A network of random weights over the range of hand features: whatever it answers, the mapping
/// around it must keep its promises. shape unknown: direct.
inline MappingNetwork random_network(model::ShapeKind shape, std::uint64_t seed,
                                     const model::HandModel& hand = barrett()) {
  Random random(seed);
  const auto outputs = static_cast<Eigen::Index>(hand.dofs().size());
  Eigen::VectorXd lower(outputs), upper(outputs);
  for (Eigen::Index i = 0; i < outputs; ++i) {
    lower[i] = hand.dofs()[static_cast<std::size_t>(i)].lower;
    upper[i] = hand.dofs()[static_cast<std::size_t>(i)].upper;
  }
  const int inputs = feature_count + (shape == model::ShapeKind::unknown ? 0 : 1);
  learning::Layer hidden(8, inputs + 1), last(outputs, 9);
  for (learning::Layer* layer : {&hidden, &last})
    for (Eigen::Index row = 0; row < layer->rows(); ++row)
      for (Eigen::Index col = 0; col < layer->cols(); ++col) (*layer)(row, col) = random.normal();
  Eigen::VectorXd low = Eigen::VectorXd::Constant(inputs, -0.2), high = -low;
  if (inputs > feature_count) low[feature_count] = 0.01, high[feature_count] = 0.08;
  return {shape,
          *learning::Network::create({hidden, last}),
          *learning::Scaling::create(low, high),
          *learning::Scaling::create(lower, upper),
          {}};
}

/// Traits of a model that keeps to the hand's own limits.
inline ModelTraits plain_traits(const model::HandModel& hand) {
  const auto dofs = static_cast<Eigen::Index>(hand.dofs().size());
  ModelTraits traits{"random", "none", SizeInput::characteristic, Eigen::VectorXd(dofs),
                     Eigen::VectorXd(dofs)};
  for (Eigen::Index i = 0; i < dofs; ++i) {
    traits.lower[i] = hand.dofs()[static_cast<std::size_t>(i)].lower;
    traits.upper[i] = hand.dofs()[static_cast<std::size_t>(i)].upper;
  }
  return traits;
}

inline MappingModel random_model(std::uint64_t seed, const model::HandModel& hand = barrett()) {
  return *MappingModel::create(hand, plain_traits(hand),
                               {random_network(model::ShapeKind::unknown, seed, hand),
                                random_network(model::ShapeKind::cylinder, seed + 1, hand),
                                random_network(model::ShapeKind::box, seed + 2, hand)});
}

/// Closes the Barrett hand by 1.8 rad, whatever it is asked.
inline MappingModel closing_model() {
  const auto constant = [](model::ShapeKind shape) {
    MappingNetwork network = random_network(shape, 1);
    network.network =
        *learning::Network::create({learning::Layer::Zero(4, network.network.inputs() + 1)});
    network.output =
        *learning::Scaling::create(Eigen::Vector4d::Zero(), Eigen::Vector4d(0, 3.6, 3.6, 3.6));
    return network;
  };
  return *MappingModel::create(
      barrett(), plain_traits(barrett()),
      {constant(model::ShapeKind::unknown), constant(model::ShapeKind::cylinder)});
}

}  // namespace prehend::mapping
