#include "services/demonstration/core/showing/people.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "common/base/motion.hpp"
#include "common/base/random.hpp"
#include "services/demonstration/core/showing/holding.hpp"
#include "services/demonstration/core/showing/objects.hpp"

namespace prehend::demonstration {

namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using model::Finger;
using model::GraspClass;
using model::HumanHand;
using model::HumanPosture;

// All of these were set before anything was recognised.

// Hands of women and men beside an average one, and how they differ [Gordon1989]; one finger beside
// the others [Chatzioglou2024].
constexpr double women = 0.965, men = 1.036, hand_sigma = 0.053, finger_sigma = 0.05;

// What differs from person to person, at one from kind to kind, and from take to take.
struct Spread {
  double person, kind, take;
};
constexpr Spread of_joints{0.08, 0.08, 0.06};     // rad
constexpr Spread of_place{0, 0.005, 0.004};       // m
constexpr Spread of_oblique{0.14, 0, 0.08};       // rad
constexpr Spread of_reach{0, 0.12, 0.1};          // rad
constexpr Spread of_row{0.1, 0.1, 0.05};          // logarithm
constexpr Spread of_bending{0.15, 0, 0.05};       // logarithm
constexpr Spread of_curl{0, 0.1, 0.06};           // closure
constexpr Spread of_direction{0.14, 0.14, 0.14};  // rad, each of three angles
constexpr double usual_oblique = 0.26;            // rad
constexpr double min_curl = 0.15, max_curl = 0.75;

// How the hand points, rad: turned about its own x, then y, then z of W.
const Vector3d from_the_side(1.57, 0.1, 0.35), from_above(0.17, 0.52, 0.17);
constexpr double other_approach = 0.2;  // of takes come from where their kind usually does not
constexpr double side_turn = 0.35;      // rad, towards objects at the left, and back
constexpr double yaw_sigma = 0.26;      // rad, of takes

// Time, speeds, sensors.
constexpr double rate = 100;                       // Hz
constexpr double median_time = 0.133;              // s, of real people's takes
constexpr double time_sigma = 0.7, longest = 0.6;  // logarithm, s
constexpr double max_open = 0.3;                   // of its way: a finger at first touch
constexpr double usual_speed = 0.1, end_speed = 0.03, speed_sigma = 0.5;  // m/s, logarithm
constexpr double sensor_place = 0.003;  // m, a sensor beside the fingertip
constexpr double noise = 0.0015;        // m, of a fingertip

HumanPosture drawn_joints(double sigma, Random& random) {
  HumanPosture made;
  for (double& angle : made) angle = random.normal(sigma);
  return made;
}

struct Habit {
  Manner manner;
  Vector3d direction = Vector3d::Zero();  // rad, more than is usual
};

/// What one of the three spreads adds to a habit.
Habit varied(Habit habit, double Spread::*part, Random& random) {
  Manner& manner = habit.manner;
  manner.posture += drawn_joints(of_joints.*part, random);
  manner.place_H += random.normal3(of_place.*part);
  manner.oblique += random.normal(of_oblique.*part);
  manner.reach_round += random.normal(of_reach.*part);
  manner.row *= std::exp(random.normal(of_row.*part));
  manner.bending.second *= std::exp(random.normal(of_bending.*part));
  manner.bending.third *= std::exp(random.normal(of_bending.*part));
  manner.curl = std::clamp(manner.curl + random.normal(of_curl.*part), 0.0, 1.0);
  habit.direction += random.normal3(of_direction.*part);
  return habit;
}

struct Showing {
  std::string name;
  HumanHand hand{1};
  std::array<Vector3d, model::finger_count> p_TS;  // sensors, in the frames of the tips
  Habit habit;
};

Showing drawn_person(std::string name, Random& random) {
  const double usual = random.uniform() < 0.5 ? women : men;
  const double scale = usual + random.normal(hand_sigma);
  std::array<double, model::finger_count> fingers{};
  for (double& length : fingers) length = std::exp(random.normal(finger_sigma));
  Showing made{std::move(name), HumanHand(scale, fingers), {}, {}};
  for (Vector3d& p : made.p_TS) p = random.normal3(sensor_place);
  made.habit.manner.oblique = usual_oblique;
  made.habit.manner.curl = random.uniform(min_curl, max_curl);
  made.habit = varied(made.habit, &Spread::person, random);
  return made;
}

Matrix3d pointing(const Vector3d& angles) {
  return (AngleAxisd(angles.z(), Vector3d::UnitZ()) * AngleAxisd(angles.y(), Vector3d::UnitY()) *
          AngleAxisd(angles.x(), Vector3d::UnitX()))
      .toRotationMatrix();
}

Matrix3d drawn_direction(const GraspClass& kind, const Habit& habit, bool left, Random& random) {
  const bool usual = random.uniform() >= other_approach;
  const bool above = (kind.approach == model::Approach::above) == usual;
  Vector3d angles = (above ? from_above : from_the_side) + habit.direction;
  angles.z() += (left ? side_turn : -side_turn) + random.normal(yaw_sigma);
  return pointing(angles);
}

/// Fingertips while the last fingers come to the object.
std::vector<HandSample> closing(const Showing& person, const GraspClass& kind,
                                const HumanPosture& held, const Matrix3d& R_WH, Random& random) {
  std::array<double, model::finger_count> left{};  // of its way, of each finger
  for (double& each : left) each = random.uniform(0, max_open);
  left[random.index(left.size())] = 0;
  const double time = std::min(longest, median_time * std::exp(random.normal(time_sigma)));
  const double hand_speed = usual_speed * std::exp(random.normal(speed_sigma));
  const double wrist_speed = hand_speed * std::exp(random.normal(speed_sigma));
  const HumanPosture open = HumanHand::open_posture();
  const int count = std::max(2, static_cast<int>(time * rate) + 1);
  std::vector<HandSample> made;
  for (int n = 0; n < count; ++n) {
    const double open_still = 1 - minimum_jerk(static_cast<double>(n) / (count - 1));
    HumanPosture now = held;
    for (int f = 0; f < model::finger_count; ++f) {
      if (!takes_part(kind, static_cast<Finger>(f))) continue;
      const int d = f == 0 ? 16 : 4 * (f - 1);
      now.segment<4>(d) += left[static_cast<std::size_t>(f)] * open_still *
                           (open.segment<4>(d) - held.segment<4>(d));
    }
    const auto tips = person.hand.fingertip_poses(now);
    std::array<Vector3d, model::finger_count> p_HS;
    for (std::size_t f = 0; f < tips.size(); ++f)
      p_HS[f] = tips[f] * person.p_TS[f] + random.normal3(noise);
    HandSample sample{.t = n / rate};
    sample.p_HF = p_HS;
    sample.scale = person.hand.scale();
    for (std::size_t f = 1; f < tips.size(); ++f)
      sample.p_thumb_tip_W[f - 1] = R_WH * (p_HS[f] - p_HS[0]);
    sample.hand_speed = end_speed + hand_speed * open_still * random.uniform(0.8, 1.2);
    sample.wrist_speed = end_speed + wrist_speed * open_still * random.uniform(0.8, 1.2);
    made.push_back(sample);
  }
  return made;
}

Take drawn_take(const Showing& person, const GraspClass& kind, const Habit& usual, int trial,
                Random& random) {
  const Habit habit = varied(usual, &Spread::take, random);
  const bool left = random.uniform() < 0.5;
  const model::Shape shape = drawn_object(kind, random);
  const Held held = holding(person.hand, kind, shape, habit.manner);
  const Matrix3d R_WH = drawn_direction(kind, habit, left, random);
  Take take{person.name, "kinds", kind.name, left ? "left" : "right", "lift", trial, {}};
  take.object = measured(shape, random);
  take.samples = closing(person, kind, held.posture, R_WH, random);
  return take;
}

}  // namespace

Expected<std::vector<Take>> drawn_takes(const model::GraspTaxonomy& taxonomy,
                                        const DrawOptions& options) {
  std::vector<const GraspClass*> kinds;
  for (const std::string_view name : measured_kinds) {
    kinds.push_back(taxonomy.find(name));
    if (!kinds.back()) return fail("is not in the taxonomy", std::string(name));
  }
  std::vector<Take> made;
  for (int p = 0; p < options.people; ++p) {
    Random random(options.seed * 1'000'003 + static_cast<std::uint64_t>(p));
    const Showing person =
        drawn_person(std::to_string(options.seed) + "-" + std::to_string(p + 1), random);
    for (const GraspClass* kind : kinds) {
      const Habit habit = varied(person.habit, &Spread::kind, random);
      for (int trial = 0; trial < options.trials; ++trial)
        made.push_back(drawn_take(person, *kind, habit, trial, random));
    }
  }
  return made;
}

}  // namespace prehend::demonstration
