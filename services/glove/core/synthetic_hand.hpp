#pragma once

#include <array>
#include <utility>

#include "common/model/catalogue.hpp"
#include "common/model/scene.hpp"
#include "services/glove/core/frame_source.hpp"
#include "services/glove/core/worn_sensors.hpp"

namespace prehend::glove {

/// A person who reaches for an object, grasps, lifts and puts it back, again and again. A value of
/// the frame's number alone: the same frame comes out whenever it is asked for.
class SyntheticHand final : public FrameSource {
 public:
  /// Fails if the scene's target is not there or no hand can grasp it.
  static Expected<SyntheticHand> create(const model::Scene& scene,
                                        const model::Catalogue& catalogue,
                                        const SyntheticOptions& options);

  std::optional<Frame> frame(std::uint64_t n) const override;

  /// The true hand at a time, s from the start of the first cycle.
  HandState hand(double time) const;
  /// s; every cycle is the same but for the noise.
  static double cycle();
  /// True pose of the hand, and of its grasp frame, when the fingers close.
  const Pose& grasp() const { return X_WH_grasp_; }
  const model::HumanHand& model() const { return hand_; }

 private:
  SyntheticHand(WornSensors sensors, double scale) : sensors_(std::move(sensors)), hand_(scale) {}

  WornSensors sensors_;
  model::HumanHand hand_;
  Pose X_WH_grasp_ = Pose::Identity(), X_WH_before_ = X_WH_grasp_, X_WH_rest_ = X_WH_grasp_;
  std::array<double, model::finger_count> closure_{};
};

}  // namespace prehend::glove
