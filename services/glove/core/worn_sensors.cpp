#include "services/glove/core/worn_sensors.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/random.hpp"

namespace prehend::glove {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

constexpr std::size_t sensor_count = 4;

Vector3d direction(Random& random) {
  while (true) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
    const Vector3d v(x, y, z);
    if (v.norm() > 0.1 && v.norm() <= 1) return v.normalized();
  }
}

}  // namespace

Expected<Target> target_of(const model::Scene& scene, const model::Catalogue& catalogue) {
  const std::string& name = scene.demonstrator.target;
  const auto placed = std::find_if(scene.objects.begin(), scene.objects.end(),
                                   [&](const auto& object) { return object.name == name; });
  const model::CatalogueObject* object = catalogue.find(name);
  if (placed == scene.objects.end() || !object)
    return fail("the target '" + name + "' is not in the scene", "synthetic hand",
                "name one of the scene's objects as demonstrator.target");
  return Target{object->shape, placed->X_WO};
}

Expected<WornSensors> WornSensors::create(const model::Demonstrator& person,
                                          const SyntheticOptions& options) {
  if (!(options.rate >= 1 && options.rate <= 1000))
    return fail("the rate must be 1 to 1000 Hz", "synthetic hand", "set glove.rate");
  return WornSensors(person, options);
}

WornSensors::WornSensors(const model::Demonstrator& person, const SyntheticOptions& options)
    : options_(options), person_(person), hand_(person.hand_scale) {
  Random random(person_.seed * 7919 + options_.seed);
  for (std::size_t s = 0; s < sensor_count; ++s) {
    const Vector3d offset = direction(random) * random.uniform(0, 0.005);
    // The back of the hand is flat and wide: its sensor sits much straighter than those on fingers.
    const double crooked = (s == 0 ? 1.5 : 10.0) * std::numbers::pi / 180;
    const AngleAxisd turn(random.uniform(0, crooked), direction(random));
    mounting_[s] = make_pose(offset, turn.toRotationMatrix());
  }
}

Frame WornSensors::frame(std::uint64_t n, const HandState& state) const {
  const auto tips = hand_.fingertip_poses(model::HumanHand::posture(state.closure));
  const Pose X_TH = options_.X_WT.inverse() * state.X_WH;

  Frame result;
  result.sequence = n;
  result.stamp = Time(seconds(time(n)));
  result.left = options_.left;
  Random random((person_.seed * 1000003 + options_.seed) * 6364136223846793005ULL + n);
  for (std::size_t s = 0; s < sensor_count; ++s) {
    Reading reading;
    reading.site = usual_sites()[s];
    const auto finger = finger_of(reading.site);
    const Pose X_HF = finger ? tips[static_cast<std::size_t>(*finger)] : Pose::Identity();
    const Pose X_TS = X_TH * X_HF * mounting_[s];
    const Vector3d turn = random.normal3(person_.angle_noise);
    reading.p_TS = X_TS.translation() + random.normal3(person_.position_noise);
    reading.q_TS = Eigen::Quaterniond(X_TS.linear());
    if (turn.norm() > 0)
      reading.q_TS = reading.q_TS * Eigen::Quaterniond(AngleAxisd(turn.norm(), turn.normalized()));
    if (random.uniform() < person_.extreme_rate)
      reading.p_TS += direction(random) * random.uniform(0.05, 0.5);
    result.readings.push_back(reading);
  }
  return result;
}

}  // namespace prehend::glove
