#include "services/recognition/tools/trials/trials.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/named_values.hpp"

namespace prehend::recognition {
namespace {

constexpr double trials_pi = std::numbers::pi;

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto place =
      static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

/// Fills in what is made of the target where it stands, and why it is not accepted.
void explain(const Detector& detector, const CameraModel& camera, const Picture& picture,
             const Eigen::Vector3d& place, TrialResult& made) {
  const auto& classes = detector.models().classes;
  const auto c = std::find_if(classes.begin(), classes.end(),
                              [&](const ObjectClass& known) { return known.name == made.target; });
  made.miss = Miss::no_outline;
  if (c == classes.end()) return;
  const auto judged =
      detector.judge(detector.prepare(picture), camera,
                     static_cast<std::size_t>(c - classes.begin()), place.x(), place.y());
  if (!judged) return;
  made.by_colours = judged->by_colours;
  made.agreement = judged->agreement;
  made.contrast = judged->contrast;
  made.measured = judged->measured;
  made.error = std::hypot(judged->at->x - place.x(), judged->at->y - place.y());
  const double accept = detector.options().accept;
  if (judged->probability >= accept && made.error <= same_place)
    made.miss = Miss::search;
  else if (made.error > same_place)
    made.miss = Miss::no_outline;
  else if (!(judged->by_colours > 0))
    made.miss = Miss::named;
  else
    made.miss = judged->by_colours < accept ? Miss::colours : Miss::outline;
}

}  // namespace

namespace {
constexpr auto miss_names = named_values<Miss>({{Miss::none, "none"},
                                                {Miss::search, "search"},
                                                {Miss::no_outline, "no outline"},
                                                {Miss::named, "named otherwise"},
                                                {Miss::colours, "colours not sure"},
                                                {Miss::outline, "outline not sure"}});
}  // namespace

std::string to_string(Miss miss) {
  return std::string(miss_names.name(miss));
}

TrialResult try_scene(const Detector& detector, const CameraModel& camera,
                      const TrialScenes& scenes, const TrialScene& given) {
  TrialResult made;
  made.target = given.target;
  made.hidden = given.hidden;
  RenderOptions options;
  options.noise_seed = given.scene.texture_seed;
  const Picture picture = scenes.renderer().render(given.scene, camera, options);
  const auto found = detector.on_table(picture, camera);
  if (!found) return made;
  for (const Sighting& sighting : *found) {
    double nearest = 1e9;
    const model::PlacedObject* object = nullptr;
    for (const model::PlacedObject& placed : given.scene.objects) {
      if (placed.name != sighting.name) continue;
      const Eigen::Vector3d p = placed.X_WO.translation();
      const double apart = std::hypot(p.x() - sighting.at->x, p.y() - sighting.at->y);
      if (apart < nearest) {
        nearest = apart;
        object = &placed;
      }
    }
    if (nearest > same_place) {
      made.false_alarms.push_back(sighting);
      continue;
    }
    made.true_ones.push_back(sighting);
    if (object != &given.scene.objects.front() || given.target.empty()) continue;
    if (sighting.probability <= made.probability) continue;
    const Eigen::Vector3d p = object->X_WO.translation();
    const Eigen::Vector2d off(sighting.at->x - p.x(), sighting.at->y - p.y());
    made.probability = sighting.probability;
    made.error = off.norm();
    made.agreement = sighting.agreement;
    made.contrast = sighting.contrast;
    made.by_colours = sighting.by_colours;
    made.measured = sighting.measured;
    made.normalised = off.dot(sighting.covariance.topLeftCorner<2, 2>().inverse() * off);
    made.distance = (camera.X_WC.translation() - p).norm();
    made.box = sighting.shape.kind == model::ShapeKind::box;
    if (!made.box) continue;
    const bool square = std::abs(sighting.shape.size.x() - sighting.shape.size.y()) < 1e-3;
    const Eigen::Matrix3d R = object->X_WO.linear();
    made.turn_error = std::abs(std::remainder(std::atan2(R(1, 0), R(0, 0)) - sighting.at->yaw,
                                              square ? trials_pi / 2 : trials_pi));
    made.normalised_turn = made.turn_error * made.turn_error / sighting.covariance(2, 2);
  }
  if (!given.target.empty() && made.probability < detector.options().accept)
    explain(detector, camera, picture, given.scene.objects.front().X_WO.translation(), made);
  return made;
}

TrialSummary summarise(Trial trial, const std::vector<TrialResult>& results, double accept) {
  TrialSummary made;
  made.trial = trial;
  std::vector<double> errors, turns;
  int boxes = 0, within = 0;
  for (const TrialResult& result : results) {
    if (result.trial != trial) continue;
    ++made.scenes;
    made.frames_with_false_alarm +=
        std::any_of(result.false_alarms.begin(), result.false_alarms.end(),
                    [&](const auto& alarm) { return alarm.probability >= accept; });
    if (result.miss != Miss::none) ++made.misses[result.miss];
    if (result.target.empty() || result.probability < accept) continue;
    ++made.detected;
    errors.push_back(result.error);
    made.normalised += result.normalised;
    within += result.normalised < 5.991;  // 95 % of chi-square with two degrees of freedom
    if (!result.box) continue;
    ++boxes;
    turns.push_back(result.turn_error);
    made.normalised_turn += result.normalised_turn;
  }
  made.error_median = quantile(errors, 0.5);
  made.error_95 = quantile(errors, 0.95);
  made.error_worst = quantile(errors, 1);
  made.turn_median = quantile(turns, 0.5);
  made.normalised /= std::max(1, made.detected);
  made.within_95 = static_cast<double>(within) / std::max(1, made.detected);
  made.normalised_turn /= std::max(1, boxes);
  return made;
}

}  // namespace prehend::recognition
