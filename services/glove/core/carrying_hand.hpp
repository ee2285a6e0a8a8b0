#pragma once

#include "common/model/catalogue.hpp"
#include "services/glove/core/worn_sensors.hpp"

namespace prehend::glove {

/// The right hand of a person who presses an object between both palms, lifts it, carries it by
/// demonstrator.carry_W, sets it down, and the next time back again. The person stands behind the
/// table's edge at -y and looks along y. A value of the frame's number alone.
class CarryingHand final : public FrameSource {
 public:
  /// Fails if the scene's target is not there.
  static Expected<CarryingHand> create(const model::Scene& scene, const model::Catalogue& catalogue,
                                       const SyntheticOptions& options);

  std::optional<Frame> frame(std::uint64_t n) const override;

  /// The true hand at a time, s from the start of the first cycle.
  HandState hand(double time) const;
  /// s, from rest to rest.
  static double cycle();

 private:
  explicit CarryingHand(WornSensors sensors) : sensors_(std::move(sensors)) {}

  WornSensors sensors_;
  Pose X_WH_ = Pose::Identity();                      // pressing, where the object stands at first
  Eigen::Vector3d out_W_ = Eigen::Vector3d::UnitX();  // unit, away from the object
  Eigen::Vector3d carry_W_ = Eigen::Vector3d::Zero();
};

}  // namespace prehend::glove
