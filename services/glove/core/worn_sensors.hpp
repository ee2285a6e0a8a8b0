#pragma once

#include <array>

#include "common/model/catalogue.hpp"
#include "common/model/human_hand.hpp"
#include "common/model/scene.hpp"
#include "services/glove/core/frame_source.hpp"

namespace prehend::glove {

struct SyntheticOptions {
  Pose X_WT = Pose::Identity();  // tracker on the table
  double rate = 30;              // Hz, 1 to 1000
  /// Numbers the sensors' noise and mounting beside the scene's own seed.
  std::uint64_t seed = 0;
  bool left = false;  // the frames are those of a left hand that was mirrored into a right one
};

/// What a computed person reaches for.
struct Target {
  model::Shape shape;
  Pose X_WO;
};
/// The demonstrator's. Fails if it is not in the scene, or not known.
Expected<Target> target_of(const model::Scene& scene, const model::Catalogue& catalogue);

/// What a person's hand does at one moment.
struct HandState {
  Pose X_WH = Pose::Identity();
  std::array<double, model::finger_count> closure{};  // for HumanHand::posture
};

/// The four sensors on a right hand of a computed person, with the noise, extreme points and
/// crooked mounting of real ones.
class WornSensors {
 public:
  /// Fails on a rate that cannot be.
  static Expected<WornSensors> create(const model::Demonstrator& person,
                                      const SyntheticOptions& options);

  /// When frame n is measured, s from the first one.
  double time(std::uint64_t n) const { return static_cast<double>(n) / options_.rate; }
  /// Frame n of a hand that does this then: always the same.
  Frame frame(std::uint64_t n, const HandState& state) const;

 private:
  WornSensors(const model::Demonstrator& person, const SyntheticOptions& options);

  SyntheticOptions options_;
  model::Demonstrator person_;
  model::HumanHand hand_;
  std::array<Pose, 4> mounting_;  // X_FS of each sensor on its finger or on the back of the hand
};

}  // namespace prehend::glove
