#include "services/mapping/tools/training/demonstrator.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace prehend::mapping {

namespace {

Eigen::Vector3d direction(Random& random) {
  Eigen::Vector3d v = random.normal3(1.0);
  while (v.norm() < 1e-6) v = random.normal3(1.0);
  return v.normalized();
}

Eigen::Matrix3d turn(Random& random, double most) {
  const Eigen::Vector3d axis = direction(random);
  return Eigen::AngleAxisd(random.uniform(0, most), axis).toRotationMatrix();
}

double drawn_scale(Random& random, double sigma) {
  return 1 + std::clamp(random.normal(sigma), -2 * sigma, 2 * sigma);
}

/// As far as index and little finger spread, rad, in HumanPosture's numbers.
constexpr std::array<std::pair<int, double>, 2> spread_apart{{{0, 0.349}, {12, -0.524}}};

/// Of the thumb's root, in the same numbers: its rotation and flexion, and how far both go from the
/// open posture, where it opposes the fingers wide open, to beside the palm, rad.
constexpr int thumb_root = 16;
constexpr double thumb_turns = 1.1, thumb_flexes = 1.1;

}  // namespace

std::array<bool, model::finger_count> fingers_of(GraspType type) {
  const bool all = type != GraspType::precision;
  return {true, true, true, all, all};
}

Demonstrator::Demonstrator(std::string user, std::uint64_t seed, const DemonstratorOptions& options)
    : user_(std::move(user)),
      options_(options),
      random_(seed),
      hand_(drawn_scale(random_, options.scale_sigma)),
      calibrated_scale_(hand_.scale() * drawn_scale(random_, options.scale_error)) {
  new_take();
}

void Demonstrator::new_take() {
  const Eigen::Matrix3d R_HR = turn(random_, options_.mounting_turn);
  const Eigen::Vector3d p_HR = direction(random_) * random_.uniform(0, options_.mounting);
  X_HR_ = make_pose(p_HR, R_HR);
  for (Eigen::Vector3d& p : p_FS_) p = direction(random_) * random_.uniform(0, options_.mounting);
}

void Demonstrator::rest(bool spreading) {
  rest_.setZero();
  // One hand in three is held ready, as the open posture has it.
  if (random_.index(3) == 0) return;
  // A flexed thumb that still opposes the fingers would be closing; so it flexes as it turns away.
  const double turned = random_.uniform();
  const double flexed = random_.uniform() * std::min(1.0, 2 * turned);
  rest_.segment<2>(thumb_root) << thumb_turns * turned, thumb_flexes * flexed;
  if (!spreading) return;
  for (const auto& [joint, limit] : spread_apart)
    rest_[joint] = random_.uniform(-1, 1) * (limit - model::HumanHand::open_posture()[joint]);
}

Fingertips Demonstrator::sense(const Closure& closure, double splay, double resting) {
  model::HumanPosture posture = model::HumanHand::posture(closure);
  posture += resting * rest_;
  for (const auto& [joint, limit] : spread_apart)
    posture[joint] += splay * (limit - posture[joint]);
  const auto tips = hand_.fingertip_poses(posture);
  Fingertips sensed;
  for (std::size_t f = 0; f < tips.size(); ++f)
    sensed[f] = {true, X_HR_.inverse() * (tips[f] * p_FS_[f]) + random_.normal3(options_.noise)};
  return sensed;
}

Features Demonstrator::read(const Closure& closure, double splay, double resting) {
  return *features(sense(closure, splay, resting),
                   calibrated_scale_);  // its own fingertips are always usable
}

Closure Demonstrator::repeat(const Closure& closure) {
  Closure repeated = closure;
  for (double& c : repeated) c = std::clamp(c + random_.normal(options_.posture_sigma), 0.0, 1.0);
  return repeated;
}

std::optional<HumanGrasp> Demonstrator::reach(const model::Shape& shape, const Pose& X_OG,
                                              GraspType type) {
  const auto taking = fingers_of(type);
  constexpr int attempts = 20;
  constexpr double stays_open = 0.05;  // sigma of the closure of a finger that takes no part
  for (int attempt = 0; attempt < attempts; ++attempt) {
    const double d = options_.approach;
    const double x = random_.uniform(-d, d), y = random_.uniform(-d, d), z = random_.uniform(-d, d);
    const Pose error = make_pose({x, y, z}, turn(random_, options_.approach_turn));
    const Pose X_OG_reached = X_OG * error;
    const Pose X_HO = hand_.X_HG() * X_OG_reached.inverse();
    Closure closure = hand_.close_on(shape, X_HO);
    if (!std::all_of(closure.begin(), closure.end(), [](double c) { return c > 0; })) continue;
    for (std::size_t f = 0; f < closure.size(); ++f)
      if (!taking[f]) closure[f] = std::min(closure[f], std::abs(random_.normal(stays_open)));
    return HumanGrasp{closure, X_OG_reached};
  }
  return std::nullopt;
}

}  // namespace prehend::mapping
