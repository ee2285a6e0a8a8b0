#pragma once

#include <array>

#include "common/model/catalogue.hpp"
#include "common/model/scene.hpp"
#include "services/glove/core/frame_source.hpp"

namespace prehend::glove {

struct SyntheticOptions {
  Pose X_WT = Pose::Identity();  // tracker on the table
  double rate = 30;              // Hz, 1 to 1000
  /// Numbers the sensors' noise and mounting beside the scene's own seed.
  std::uint64_t seed = 0;
};

/// What a demonstrator's hand does at one moment.
struct HandState {
  Pose X_WH = Pose::Identity();
  std::array<double, model::finger_count> closure{};  // for HumanHand::posture
};

/// A person who reaches for an object, grasps, lifts and puts it back, again and again, and the
/// four sensors on that hand, with the noise, extreme points and crooked mounting of real ones. A
/// value of the frame's number alone: the same frame comes out whenever it is asked for.
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
  SyntheticHand(const model::Scene& scene, const SyntheticOptions& options);

  SyntheticOptions options_;
  model::Demonstrator person_;
  model::HumanHand hand_;
  Pose X_WH_grasp_ = Pose::Identity(), X_WH_before_ = X_WH_grasp_, X_WH_rest_ = X_WH_grasp_;
  std::array<double, model::finger_count> closure_{};
  std::array<Pose, 4> mounting_;  // X_FS of each sensor on its finger or on the back of the hand
};

}  // namespace prehend::glove
