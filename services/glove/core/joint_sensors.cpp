#include "services/glove/core/joint_sensors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace prehend::glove {
namespace {

using model::HumanPosture;

constexpr double min_movement = 8;  // counts, from which a gain can be told
constexpr double distal_to_middle = 0.6;

/// First dof of index, middle, ring, little and thumb: abduction, MCP, PIP, DIP; of the thumb:
/// rotation, flexion, MCP, IP.
constexpr int index = 0, middle = 4, ring = 8, little = 12, thumb = 16;
constexpr std::array fingers{index, middle, ring, little};

constexpr std::array fingers_by_sensor{thumb, index, middle, ring, little};

/// How far the joints of a finger are bent together, 0 as an open hand's, 1 as a fist's: what a
/// string along it tells. first: its first dof.
double bent_by(const HumanPosture& posture, int first) {
  const HumanPosture open = model::HumanHand::open_posture();
  const HumanPosture fist = model::HumanHand::fist_posture();
  return (posture - open).segment<3>(first + 1).sum() / (fist - open).segment<3>(first + 1).sum();
}

/// What bends with a whole finger, told by one joint that bends much: 0 counts open, 255 a fist.
std::vector<JointSensor> sensors_of_fingers() {
  constexpr std::pair<std::string_view, int> told_by[] = {{"thumb", thumb + 3},
                                                          {"index", index + 2},
                                                          {"middle", middle + 2},
                                                          {"ring", ring + 2},
                                                          {"little", little + 2}};
  const HumanPosture open = model::HumanHand::open_posture();
  const HumanPosture fist = model::HumanHand::fist_posture();
  std::vector<JointSensor> made;
  for (const auto& [name, dof] : told_by) {
    const double gain = (fist[dof] - open[dof]) / 255;
    made.push_back({name, dof, false, gain, -open[dof] / gain});
  }
  return made;
}

/// Angles of the joint that tells of a finger, rad.
struct FingerWay {
  double open, fist;
};

FingerWay way_of(std::size_t finger) {
  static const auto sensors = sensors_of_fingers();
  const int dof = sensors[finger].dof;
  return {model::HumanHand::open_posture()[dof], model::HumanHand::fist_posture()[dof]};
}

/// What the sensor tells of a posture as the angle of its joint, rad.
double angle_told(const HumanPosture& posture, const std::vector<JointSensor>& sensors,
                  std::size_t s) {
  if (sensors.size() != finger_sensors) return posture[sensors[s].dof];
  const auto [open, fist] = way_of(s);
  return open + bent_by(posture, fingers_by_sensor[s]) * (fist - open);
}

std::vector<double> mean(const std::vector<std::vector<double>>& samples) {
  std::vector<double> sum(samples.front().size());
  for (const auto& sample : samples)
    for (std::size_t s = 0; s < sum.size(); ++s)
      sum[s] += sample[s] / static_cast<double>(samples.size());
  return sum;
}

}  // namespace

const std::vector<JointSensor>& joint_sensors() {
  static const std::vector<JointSensor> sensors{
      {"thumb rotation", thumb, true, -0.0172, 150},
      {"thumb MCP", thumb + 2, true, 0.0142, 80},
      {"thumb IP", thumb + 3, true, 0.0185, 80},
      {"thumb abduction", thumb + 1, true, 0.0152, 128},
      {"index MCP", index + 1, true, 0.0148, 80},
      {"index PIP", index + 2, true, 0.0130, 80},
      {"index DIP", index + 3, false, 0.0113, 80},
      {"middle MCP", middle + 1, true, 0.0194, 80},
      {"middle PIP", middle + 2, true, 0.0162, 80},
      {"middle DIP", middle + 3, false, 0.0123, 80},
      {"index-middle abduction", index, true, -0.0056, 128},
      {"ring MCP", ring + 1, true, 0.0217, 80},
      {"ring PIP", ring + 2, true, 0.0186, 80},
      {"ring DIP", ring + 3, false, 0.0126, 80},
      {"middle-ring abduction", ring, true, 0.0057, 128},
      {"little MCP", little + 1, true, 0.0266, 80},
      {"little PIP", little + 2, true, 0.0178, 80},
      {"little DIP", little + 3, false, 0.0124, 80},
      {"ring-little abduction", little, true, 0.0103, 128},
      {"palm arch", -1, true, 0.01, 128},
      {"wrist pitch", -1, true, 0.01, 128},
      {"wrist yaw", -1, true, 0.01, 128}};
  return sensors;
}

std::vector<JointSensor> joint_sensors_of(std::size_t count) {
  if (count == max_joint_sensors) return joint_sensors();
  if (count == finger_sensors) return sensors_of_fingers();
  std::vector<JointSensor> sensors;
  if (count != min_joint_sensors) return sensors;
  for (const JointSensor& sensor : joint_sensors())
    if (sensor.of_eighteen) sensors.push_back(sensor);
  return sensors;
}

Expected<JointGains> typical_gains(std::size_t count) {
  const auto sensors = joint_sensors_of(count);
  if (sensors.empty())
    return fail(fmt::format("a joint-angle glove has 5, 18 or 22 sensors, not {}", count));
  JointGains gains;
  for (const JointSensor& sensor : sensors) {
    gains.gain.push_back(sensor.gain);
    gains.offset.push_back(-sensor.gain * sensor.zero);
  }
  return gains;
}

Expected<void> check(const JointGains& gains) {
  const std::string where(joint_gains_table);
  if (joint_sensors_of(gains.gain.size()).empty() || gains.gain.size() != gains.offset.size())
    return fail("needs 5, 18 or 22 gains and as many offsets", where, "calibrate again");
  for (std::size_t s = 0; s < gains.gain.size(); ++s)
    if (!std::isfinite(gains.gain[s]) || !std::isfinite(gains.offset[s]) || gains.gain[s] == 0)
      return fail(fmt::format("gain or offset {} is not a usable number", s + 1), where,
                  "calibrate again");
  return {};
}

HumanPosture joint_angles(const std::vector<double>& counts, const JointGains& gains) {
  if (counts.size() == finger_sensors)
    return model::HumanHand::posture(finger_closures(counts, gains));
  const auto sensors = joint_sensors_of(counts.size());
  HumanPosture posture = HumanPosture::Zero();
  for (std::size_t s = 0; s < sensors.size() && s < gains.gain.size(); ++s)
    if (sensors[s].dof >= 0) posture[sensors[s].dof] = gains.gain[s] * counts[s] + gains.offset[s];
  if (counts.size() == min_joint_sensors)
    for (const int finger : fingers) posture[finger + 3] = distal_to_middle * posture[finger + 2];
  return model::HumanHand(1).clamp(posture);
}

std::array<double, model::finger_count> finger_closures(const std::vector<double>& counts,
                                                        const JointGains& gains) {
  std::array<double, model::finger_count> closures{};
  for (std::size_t f = 0; f < closures.size() && f < gains.gain.size(); ++f) {
    const auto [open, fist] = way_of(f);
    closures[f] = (gains.gain[f] * counts[f] + gains.offset[f] - open) / (fist - open);
  }
  return closures;
}

double finger_count_at(double closure, std::size_t finger, const JointGains& gains) {
  const auto [open, fist] = way_of(finger);
  return (open + closure * (fist - open) - gains.offset[finger]) / gains.gain[finger];
}

std::vector<double> joint_counts(const HumanPosture& posture, const JointGains& gains) {
  const auto sensors = joint_sensors_of(gains.gain.size());
  std::vector<double> counts;
  for (std::size_t s = 0; s < sensors.size(); ++s) {
    const int dof = sensors[s].dof;
    const double count =
        dof < 0 ? 128 : (angle_told(posture, sensors, s) - gains.offset[s]) / gains.gain[s];
    counts.push_back(std::clamp(count, 1.0, 255.0));
  }
  return counts;
}

HumanPosture pinch_posture() {
  HumanPosture q;
  q << -0.06, 0.89, 0.85, 0.51,  // index
      0.00, 0.60, 0.80, 0.40,    // middle
      -0.10, 0.60, 0.80, 0.40,   // ring
      -0.20, 0.60, 0.80, 0.40,   // little
      0.00, -0.35, 0.49, 0.41;   // thumb
  return q;
}

Expected<JointGains> fit_gains(const std::vector<std::vector<double>>& open,
                               const std::vector<std::vector<double>>& fist,
                               const std::vector<std::vector<double>>& pinch) {
  const std::string where = "calibration of the joint-angle glove";
  for (const auto* samples : {&open, &fist, &pinch}) {
    if (samples->empty()) return fail("there are no samples", where, "hold each pose longer");
    for (const auto& sample : *samples)
      if (sample.size() != open.front().size())
        return fail("samples have different numbers of sensors", where, "use one glove for it");
  }
  auto gains = typical_gains(open.front().size());
  if (!gains) return gains;
  const auto sensors = joint_sensors_of(open.front().size());
  const std::array counts{mean(open), mean(fist), mean(pinch)};
  const std::array postures{model::HumanHand::open_posture(), model::HumanHand::fist_posture(),
                            pinch_posture()};
  int moved = 0;
  for (std::size_t s = 0; s < sensors.size(); ++s) {
    const int dof = sensors[s].dof;
    if (dof < 0) continue;
    const std::size_t used = dof < middle || dof >= thumb ? 3 : 2;
    std::array<double, 3> angle{};
    double x = 0, y = 0;
    for (std::size_t k = 0; k < used; ++k) {
      angle[k] = angle_told(postures[k], sensors, s);
      x += counts[k][s] / static_cast<double>(used), y += angle[k] / static_cast<double>(used);
    }
    double xx = 0, xy = 0, low = counts[0][s], high = low;
    for (std::size_t k = 0; k < used; ++k) {
      xx += (counts[k][s] - x) * (counts[k][s] - x);
      xy += (counts[k][s] - x) * (angle[k] - y);
      low = std::min(low, counts[k][s]), high = std::max(high, counts[k][s]);
    }
    if (high - low >= min_movement && std::abs(xy) > 1e-9 * xx) {
      gains->gain[s] = xy / xx;
      gains->offset[s] = y - gains->gain[s] * x;
      ++moved;
    } else {
      gains->offset[s] = angle[0] - gains->gain[s] * counts[0][s];
    }
  }
  if (moved < 4)
    return fail("hardly any sensor moved between open hand and fist", where,
                "check that the glove is worn, and that the poses differ");
  return gains;
}

}  // namespace prehend::glove
