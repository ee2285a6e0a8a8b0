#pragma once

#include <array>

#include "common/base/random.hpp"
#include "common/model/human_hand.hpp"
#include "services/mapping/core/mapping.hpp"
#include "services/mapping/core/mapping_model.hpp"
#include "tests/support/hands.hpp"
#include "tests/support/models/random_model.hpp"

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

using test::plain_traits;

inline MappingNetwork random_network(model::ShapeKind shape, std::uint64_t seed) {
  return test::random_network(barrett(), shape, seed);
}

inline MappingModel random_model(std::uint64_t seed, const model::HandModel& hand = barrett()) {
  return test::random_model(hand, seed);
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
