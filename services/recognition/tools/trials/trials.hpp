#pragma once

#include <map>

#include "services/recognition/core/detection/detector.hpp"
#include "services/recognition/tools/trials/trial_scenes.hpp"

namespace prehend::recognition {

/// Why a target was missed: what is made of it when it is measured where it stands.
enum class Miss {
  none,        // it was not missed
  search,      // measured there it would be accepted: it was not looked for there, or hidden by
               // something that was found before it
  no_outline,  // its outline is nowhere near
  named,       // its colours name another class
  colours,     // its colours are not sure enough
  outline,     // the outline lowers what the colours say below what is accepted
};
std::string to_string(Miss miss);

/// What became of one scene.
struct TrialResult {
  Trial trial = Trial::open;
  std::uint64_t seed = 0;
  std::string target;          // empty: none
  double probability = 0;      // of the target where it stands; 0: not seen there
  double error = 0;            // m, horizontal
  double turn_error = 0;       // rad, of boxes
  double distance = 0;         // m, camera to target
  double normalised = 0;       // squared error of x, y over its covariance: chi-square of 2
  double normalised_turn = 0;  // the same of a box' turn: chi-square of 1
  bool box = false;
  double agreement = 0, contrast = 0, hidden = 0;
  Eigen::Vector2d measured = {1, 1};
  double by_colours = 0;
  Miss miss = Miss::none;
  /// What is said to stand where nothing of that name stands.
  std::vector<Sighting> false_alarms;
  /// What is said to stand where such a thing stands, targets or not.
  std::vector<Sighting> true_ones;
};

/// A sighting belongs to an object when it is at most this far from it, m.
inline constexpr double same_place = 0.05;

/// Looks at a rendered scene. A target that the detector does not accept is measured where it
/// stands, and the result tells of that measurement why.
TrialResult try_scene(const Detector& detector, const CameraModel& camera,
                      const TrialScenes& scenes, const TrialScene& scene);

/// Over scenes of a kind; those with a target, detected when seen with `accept` or more.
struct TrialSummary {
  Trial trial = Trial::open;
  int scenes = 0, detected = 0;
  int frames_with_false_alarm = 0;                         // of at least `accept`
  double error_median = 0, error_95 = 0, error_worst = 0;  // m, of the detected
  double turn_median = 0;                                  // rad, of the detected boxes
  /// Mean normalised squared errors, 2 and 1 when the covariances are true, and the share of
  /// detections whose place lies within the ellipse of 95 %.
  double normalised = 0, normalised_turn = 0, within_95 = 0;
  std::map<Miss, int> misses;
};
TrialSummary summarise(Trial trial, const std::vector<TrialResult>& results, double accept);

}  // namespace prehend::recognition
