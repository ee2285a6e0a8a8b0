#pragma once

#include <array>
#include <prehend/base/random.hpp>
#include <prehend/mapping/mapping.hpp>
#include <prehend/mapping/mapping_model.hpp>
#include <prehend/model/human_hand.hpp>
#include <stdexcept>

namespace prehend::mapping {

/// The Barrett hand of the lab.
inline const model::HandModel& barrett() {
  static const model::HandModel hand = [] {
    auto loaded = model::HandModel::load(PREHEND_SOURCE "/common/models/hands/barrett");
    if (!loaded) throw std::runtime_error(loaded.error().message());
    return *loaded;
  }();
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
inline MappingNetwork random_network(model::ShapeKind shape, std::uint64_t seed) {
  Random random(seed);
  const int inputs = feature_count + (shape == model::ShapeKind::unknown ? 0 : 1);
  learning::Layer hidden(8, inputs + 1), last(4, 9);
  for (learning::Layer* layer : {&hidden, &last})
    for (Eigen::Index row = 0; row < layer->rows(); ++row)
      for (Eigen::Index col = 0; col < layer->cols(); ++col) (*layer)(row, col) = random.normal();
  Eigen::VectorXd low = Eigen::VectorXd::Constant(inputs, -0.2), high = -low;
  if (inputs > feature_count) low[feature_count] = 0.01, high[feature_count] = 0.08;
  return {shape,
          *learning::Network::create({hidden, last}),
          *learning::Scaling::create(low, high),
          *learning::Scaling::create(Eigen::Vector4d::Zero(), Eigen::Vector4d(0.8, 2, 2, 2)),
          {}};
}

inline MappingModel random_model(std::uint64_t seed) {
  return *MappingModel::create(barrett(), "random", "none",
                               {random_network(model::ShapeKind::unknown, seed),
                                random_network(model::ShapeKind::cylinder, seed + 1),
                                random_network(model::ShapeKind::box, seed + 2)});
}

}  // namespace prehend::mapping
