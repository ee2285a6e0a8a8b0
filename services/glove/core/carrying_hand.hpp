#pragma once

#include <span>

#include "common/model/catalogue.hpp"
#include "services/glove/core/worn_sensors.hpp"

namespace prehend::glove {

/// One hand of a person who carries an object by demonstrator.carry_W with both: presses it between
/// the palms, and the next time carries it back; or, once, takes it with the left hand and hands it
/// over to the right one. The person stands behind the table's edge at -y and looks along y. A
/// value of the frame's number alone.
class CarryingHand final : public FrameSource {
 public:
  /// Fails if the scene's target is not there.
  static Expected<CarryingHand> create(const model::Scene& scene, const model::Catalogue& catalogue,
                                       const SyntheticOptions& options);

  std::optional<Frame> frame(std::uint64_t n) const override;

  /// The true hand at a time, s from the start of the first cycle.
  HandState hand(double time) const;
  /// s, from rest to rest.
  double cycle() const;

 private:
  /// Where the hand has got when a step of it ends; between steps it goes smoothly.
  struct Step {
    double lasts;    // s
    double near;     // 0: waits, 1: beside the object
    double there;    // 1: at the object
    double closed;   // 1: its fingers, as far as they go around it
    double lifted;   // 1: by lifted_by
    double carried;  // 1: by carry_W
  };
  static const std::array<Step, 10> presses, gives;
  static const std::array<Step, 11> takes;

  explicit CarryingHand(WornSensors sensors) : sensors_(std::move(sensors)) {}

  WornSensors sensors_;
  std::span<const Step> steps_;
  bool again_ = true;                                 // there and back, for ever
  Pose X_WH_ = Pose::Identity();                      // at the object, where it stands at first
  Eigen::Vector3d out_W_ = Eigen::Vector3d::UnitX();  // unit, away from the object
  Eigen::Vector3d carry_W_ = Eigen::Vector3d::Zero();
  std::array<double, model::finger_count> closure_{};
};

}  // namespace prehend::glove
