#include "mapping.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <prehend/model/human_hand.hpp>
#include <prehend/model/placement.hpp>
#include <utility>

namespace prehend::mapping {

namespace {

constexpr std::array<std::pair<FingerMode, std::string_view>, 4> finger_modes{{
    {FingerMode::joints, "joints"},
    {FingerMode::cartesian, "cartesian"},
    {FingerMode::combined, "combined"},
    {FingerMode::retargeting, "retargeting"},
}};

/// How much of the fingertips' answer the combined mode takes in the end: what is held by the tips
/// needs them in place, what is wrapped needs the fingers' shape.
double precision_of(GraspType type) {
  switch (type) {
    case GraspType::precision:
      return 1;
    case GraspType::circular_sphere:
      return 0.5;
    case GraspType::power_wrap:
    case GraspType::none:
      break;
  }
  return 0;
}

retargeting::HumanTips tips_in_grasp_frame(const Fingertips& fingertips, const Pose& X_HG) {
  const Pose X_GH = X_HG.inverse();
  retargeting::HumanTips p_GT;
  for (std::size_t f = 0; f < fingertips.size(); ++f)
    if (fingertips[f].valid) p_GT[f] = X_GH * fingertips[f].p_HF;
  return p_GT;
}

}  // namespace

std::string_view to_string(FingerMode mode) {
  for (const auto& [known, name] : finger_modes)
    if (known == mode) return name;
  return "unknown";
}

std::optional<FingerMode> finger_mode_from_string(std::string_view name) {
  for (const auto& [mode, known] : finger_modes)
    if (known == name) return mode;
  return std::nullopt;
}

Expected<Mapping> Mapping::create(const model::HandModel& hand, const MappingModel& model,
                                  const MappingOptions& options) {
  Mapping made(hand, model, options);
  if (auto used = made.use(options.fingers, options.intelligent, options.place); !used)
    return tl::unexpected(used.error());
  return made;
}

Expected<void> Mapping::use(FingerMode fingers, bool intelligent, bool place) {
  std::optional<retargeting::Retargeter> retargeter;
  if (fingers != FingerMode::joints) {
    const auto method = fingers == FingerMode::retargeting ? retargeting::Method::vector
                                                           : retargeting::Method::cartesian;
    auto made = retargeting::Retargeter::create(hand_, method);
    if (!made) return tl::unexpected(made.error());
    retargeter.emplace(std::move(*made));
  }
  retargeter_.swap(retargeter);
  options_.fingers = fingers;
  options_.intelligent = intelligent;
  options_.place = place;
  return {};
}

Mapping::Mapping(const model::HandModel& hand, const MappingModel& model,
                 const MappingOptions& options)
    : hand_(hand),
      model_(model),
      options_(options),
      arbitration_(options.ramp),
      grip_(hand, options.grip),
      arrival_(hand),
      follow_through_(hand),
      right_of_way_(hand) {}

Expected<void> Mapping::on_detection(const Detection& detection) {
  if (!is_valid(detection.shape)) return fail("detection without a shape");
  if (!is_finite(detection.X_WO)) return fail("detection not finite");
  if (!(detection.probability >= options_.least_probability))
    return fail("detection not confident");
  if (!detection.covariance.allFinite() || (detection.covariance.diagonal().array() < 0).any())
    return fail("detection without a usable covariance");
  const double size = characteristic_size(detection.shape);
  const auto [known, is_new] = tracks_.try_emplace(detection.track, Track{detection, size});
  if (is_new) return {};
  Track& track = known->second;
  // Late ones must not bring back an older place.
  if (track.detection.stamp > detection.stamp) return fail("detection out of order");
  track.detection = detection;
  constexpr double newest = 0.2;  // share of the newest size in mean and variance
  const double off = size - track.size;
  track.size += newest * off;
  track.size_variance = (1 - newest) * (track.size_variance + newest * off * off);
  return {};
}

void Mapping::on_detection_gone(std::uint32_t track) {
  tracks_.erase(track);
}

Expected<void> Mapping::on_state(const RobotState& state) {
  const auto dofs = static_cast<Eigen::Index>(hand_.dofs().size());
  const auto joints = static_cast<Eigen::Index>(hand_.joints().size());
  if (state.dof.size() != dofs || state.velocity.size() != joints || state.torque.size() != joints)
    return fail("robot state of another hand");
  if (!state.dof.allFinite() || !state.velocity.allFinite() || !state.torque.allFinite() ||
      !is_finite(state.X_WB))
    return fail("robot state not finite");
  grip_.observe(state, command_.dof);
  state_ = state;
  return {};
}

/// Where the first command begins: where the robot hand is; without word from it, where it shall
/// be.
bool Mapping::start(const Pose& X_WG, Time stamp, Time now) {
  if (!first_posture_) first_posture_ = now;
  if (!state_ && now - *first_posture_ < options_.state_wait) return false;
  time_ = stamp;
  if (!state_) {
    command_.dof = hand_.clamp(hand_.postures().at("open"));
    command_.X_WB = X_WG * hand_.X_BG().inverse();
    return true;
  }
  // A hand that presses on something does so with a squeeze and perhaps a corrected placement: both
  // stay.
  command_.dof = grip_.squeeze(hand_.clamp(state_->dof));
  command_.X_WB = state_->X_WB;
  if (grip_.touching())
    correction_ = limit_step(Pose::Identity(), X_WG.inverse() * state_->X_WB * hand_.X_BG(),
                             options_.correct_distance, options_.correct_angle);
  return true;
}

/// How far a detection can be relied on, 0 to 1: see MappingOptions::sure_position.
double Mapping::trust(const Track& track) const {
  const Eigen::Matrix4d& covariance = track.detection.covariance;
  const auto share = [](double tolerance, double variance) {
    return std::min(1.0, tolerance * tolerance / std::max(variance, 1e-12));
  };
  const double position =
      covariance.topLeftCorner<3, 3>().selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff();
  double least = share(options_.sure_position, position);
  if (track.detection.shape.kind == model::ShapeKind::box)
    least = std::min(least, share(options_.sure_turn, covariance(3, 3)));
  return std::min(least, share(options_.sure_size * track.size, track.size_variance));
}

std::optional<Mapping::Candidate> Mapping::candidate(const Track& track, const Pose& X_WG,
                                                     bool engaged) const {
  const Detection& detection = track.detection;
  const auto X_OG =
      model::nearest_grasp(detection.shape, detection.X_WO.inverse() * X_WG, hand_.reach());
  if (!X_OG) return std::nullopt;
  Candidate found{detection, trust(track),
                  0,         detection.X_WO * *X_OG,
                  *X_OG,     place_for(model_.traits().places, detection.shape, *X_OG)};
  found.distance = (found.X_WG.translation() - X_WG.translation()).norm();
  const double angle = angle_between(found.X_WG.linear(), X_WG.linear());
  if (found.distance > (engaged ? options_.leave : options_.enter) ||
      angle > (engaged ? options_.leave_angle : options_.enter_angle))
    return std::nullopt;
  return found;
}

/// The object within reach: the engaged one, while there is one and no other is clearly nearer.
std::optional<Mapping::Candidate> Mapping::choose(const Pose& X_WG, Time now) {
  if (!options_.intelligent && !options_.place) return std::nullopt;
  std::erase_if(tracks_, [&](const auto& entry) {
    return std::chrono::abs(now - entry.second.detection.stamp) > options_.fresh;
  });
  std::optional<Candidate> nearest, kept;
  for (const auto& [number, track] : tracks_) {
    if (!model_.knows(track.detection.shape.kind)) continue;
    const bool engaged = engaged_ && engaged_->detection.track == number;
    auto found = candidate(track, X_WG, engaged);
    if (!found) continue;
    if (engaged) kept = found;
    if (!nearest || found->distance < nearest->distance) nearest = std::move(found);
  }
  if (!engaged_) return nearest;
  // Another one takes over only after the weight of this one has gone to 0.
  if (kept && nearest->distance < kept->distance - options_.prefer) return std::nullopt;
  return kept;
}

/// Follows the trust in what is seen no faster than the weight moves. What is gripped or lost keeps
/// the trust that it had.
void Mapping::update_trust(const std::optional<Candidate>& seen, Duration elapsed) {
  if (arbitration_.phase() == Phase::direct) trust_ = 0;
  if (!seen || arbitration_.phase() == Phase::gripping) return;
  const double change = to_seconds(elapsed) / to_seconds(options_.ramp);
  trust_ += std::clamp(seen->trust - trust_, -change, change);
}

/// As near to the grasp as may be corrected: turned first and moved sideways, so that the fingers
/// go past the object on both sides. The way along the approach is the operator's, until no more of
/// it is left than can be corrected.
Pose Mapping::toward(const Pose& X_WG, const Pose& X_WG_grasp) const {
  const double most = options_.correct_distance;
  Eigen::Vector3d off = X_WG_grasp.inverse() * X_WG.translation();
  const double beside = off.head<2>().norm(), before = std::abs(off.z());
  const double sideways = std::min(beside, most);
  const double left = std::sqrt(most * most - sideways * sideways);
  const double along = before <= left ? before : std::max(0.0, 2 * left - before);
  if (beside > 0) off.head<2>() *= 1 - sideways / beside;
  if (before > 0) off.z() *= 1 - along / before;
  const Pose moved = make_pose(X_WG_grasp * off, X_WG_grasp.linear());
  return limit_step(X_WG, moved, most, options_.correct_angle);
}

/// How far the grasp frame `X_WG` must move along its y, in which fingers close, m, so that a
/// finger that has come near the object does not push it while those on the other side are still on
/// their way: then the hand yields instead of the object.
double Mapping::yielding(const Pose& X_WG) const {
  const Pose X_OG = engaged_->detection.X_WO.inverse() * X_WG;
  const auto distances = [&](double y) -> Eigen::ArrayXd {
    const Pose X_OG_moved = X_OG * Eigen::Translation3d(0, y, 0);
    return arrival_.distances(command_.dof, engaged_->detection.shape,
                              hand_.X_BG() * X_OG_moved.inverse());
  };
  constexpr double step = 0.002;  // m
  const Eigen::ArrayXd less = distances(-step), more = distances(step);
  constexpr double far = 1;  // m
  double rising = far, falling = far;
  for (Eigen::Index f = 0; f < less.size(); ++f) {
    // Fingers that are not beside the object do not push it sideways.
    const double slope = (more[f] - less[f]) / (2 * step);
    double& nearest = slope > 0 ? rising : falling;
    if (std::abs(slope) > 0.5) nearest = std::min(nearest, 0.5 * (more[f] + less[f]));
  }
  const double room = options_.yield;
  if (falling < room && rising > room) return -std::min(room - falling, rising - room);
  if (rising < room && falling > room) return std::min(room - rising, falling - room);
  return 0;
}

/// The hand's grasp frame with its placement corrected toward the object's nearest grasp.
Pose Mapping::corrected(const Pose& X_WG, const std::optional<Candidate>& seen, Duration elapsed) {
  const double t = to_seconds(elapsed);
  // In a grip, the object moves with the hand: what was corrected stays.
  if (arbitration_.phase() != Phase::gripping) {
    if (arbitration_.phase() == Phase::direct || !options_.place) {
      full_correction_ = Pose::Identity();
      yielded_ = 0;
    } else if (seen && arbitration_.phase() != Phase::leaving) {
      const auto aside = [&] {
        return seen->X_WG * Eigen::Translation3d(seen->p_GR + Eigen::Vector3d(0, yielded_, 0));
      };
      if (options_.intelligent && engaged_)
        yielded_ = std::clamp(yielded_ + yielding(aside()), -options_.correct_distance,
                              options_.correct_distance);
      full_correction_ = X_WG.inverse() * toward(X_WG, aside());
    }
    const Pose wanted = interpolate(Pose::Identity(), full_correction_, weight());
    correction_ = limit_step(correction_, wanted, options_.correct_speed * t,
                             options_.correct_turn_speed * t);
  }
  return X_WG * correction_;
}

/// Two fingers of this posture reach into the object, where the hand is now.
bool Mapping::closed_on_object(const Eigen::VectorXd& dof) const {
  const Eigen::VectorXd distances = arrival_.distances(
      dof, engaged_->detection.shape, command_.X_WB.inverse() * engaged_->detection.X_WO);
  return (distances.array() < 0.002).count() >= 2;
}

/// Mean angle of the closing DoFs from their open end, rad.
double Mapping::mean_closing(const Eigen::VectorXd& dof) const {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < hand_.dofs().size(); ++i) {
    const model::HandDof& d = hand_.dofs()[i];
    if (d.closing == 0) continue;
    sum += d.closing * (dof[static_cast<Eigen::Index>(i)] - (d.closing > 0 ? d.lower : d.upper));
    ++count;
  }
  return count == 0 ? 0 : sum / count;
}

/// together: how much, 0 to 1, the fingers close in proportion and slowly enough to arrive
/// together, since one that came first would push the object away.
void Mapping::move_toward(const Eigen::VectorXd& dof, const Pose& X_WB, double together,
                          Duration elapsed) {
  const double t = to_seconds(elapsed);
  const Eigen::VectorXd change = dof - command_.dof;
  const auto closes = [&](Eigen::Index i) {
    return hand_.dofs()[static_cast<std::size_t>(i)].closing * change[i] > 0;
  };
  const auto speed = [&](Eigen::Index i) {
    const model::HandDof& limits = hand_.dofs()[static_cast<std::size_t>(i)];
    const double most = limits.max_velocity;
    if (!closes(i)) return most;
    return most + together * (std::min(most, options_.closing_speed * radian_of(limits)) - most);
  };
  double slowest = 1;
  for (Eigen::Index i = 0; i < change.size(); ++i)
    if (closes(i)) slowest = std::min(slowest, speed(i) * t / std::abs(change[i]));
  Eigen::VectorXd next = command_.dof;
  for (Eigen::Index i = 0; i < change.size(); ++i) {
    const double most = speed(i) * t;
    const double alone = std::clamp(change[i], -most, most);
    next[i] += closes(i) ? alone + together * (slowest * change[i] - alone) : alone;
  }
  command_.dof = right_of_way_.go(command_.dof, next);
  command_.X_WB =
      limit_step(command_.X_WB, X_WB, options_.base_speed * t, options_.base_turn_speed * t);
}

/// The fingers' answer as if no object were known.
Expected<Eigen::VectorXd> Mapping::without_object(const Posture& posture, const Answer& joints,
                                                  Duration elapsed) {
  if (!retargeter_) return joints.dof;
  const Pose X_HG = model::HumanHand(posture.hand_scale).X_HG();
  auto fingertips = retargeter_->answer(tips_in_grasp_frame(posture.fingertips, X_HG),
                                        X_HG.inverse().translation(), command_.dof);
  if (!fingertips || options_.fingers != FingerMode::combined) return fingertips;
  const double change = to_seconds(elapsed) / to_seconds(options_.ramp);
  precision_ += std::clamp(precision_of(command_.grasp_type) - precision_, -change, change);
  return joints.dof + precision_ * (*fingertips - joints.dof);
}

Expected<Command> Mapping::on_posture(const Posture& posture, Time now) {
  const auto features = mapping::features(posture.fingertips, posture.hand_scale);
  if (!features) return tl::unexpected(features.error());
  if (!is_finite(posture.X_WH)) return fail("pose of the hand not finite");
  if (std::chrono::abs(now - posture.stamp) > options_.fresh) return fail("posture stale");

  const Pose X_WG = posture.X_WH * model::HumanHand(posture.hand_scale).X_HG();
  if (command_.dof.size() == 0 && !start(X_WG, posture.stamp, now))
    return fail("no robot state yet");
  const Duration elapsed =
      std::clamp(posture.stamp - time_, Duration::zero(), options_.longest_step);
  time_ = std::max(time_, posture.stamp);

  const auto seen = choose(X_WG, posture.stamp);
  const Phase before = arbitration_.phase();
  arbitration_.step(seen.has_value(), grip_.touching(), elapsed);
  if (arbitration_.phase() == Phase::direct)
    engaged_.reset();
  else if (seen && before != Phase::gripping)
    engaged_ = seen;

  update_trust(seen, elapsed);

  const Answer joints = model_.direct(*features);
  auto imitated = without_object(posture, joints, elapsed);
  if (!imitated) return tl::unexpected(imitated.error());
  Eigen::VectorXd dof = std::move(*imitated);
  command_.extrapolating = joints.extrapolating;
  command_.weight = weight();
  command_.object.clear();
  if (engaged_ && command_.weight > 0) {
    command_.object = engaged_->detection.name;
    if (options_.intelligent) {
      // choose() lets through only shapes that have a network.
      const Answer known =
          *model_.intelligent(*features, engaged_->detection.shape, engaged_->X_OG);
      dof += command_.weight * (known.dof - dof);
      command_.extrapolating = known.extrapolating || (joints.extrapolating && command_.weight < 1);
    }
  }
  command_.mode = command_.object.empty() ? Mode::direct : Mode::intelligent;
  dof = model_.limited(dof);
  command_.grasp_type =
      mapping::grasp_type(mean_closing(dof), X_WG, model_.is_precision(*features));

  const Pose X_WB = corrected(X_WG, seen, elapsed) * hand_.X_BG().inverse();
  if (engaged_ && options_.intelligent && command_.weight > 0.99)
    dof = model_.limited(
        follow_through_.go_on(dof, closed_on_object(dof), grip_.touching(), elapsed));
  else
    follow_through_.reset();
  move_toward(model_.limited(grip_.squeeze(dof)), X_WB, options_.intelligent ? command_.weight : 0,
              elapsed);
  command_.stamp = posture.stamp;
  command_.origin = posture.origin;
  last_answer_ = now;
  return command_;
}

std::optional<Command> Mapping::tick(Time now) {
  if (!last_answer_ || now - *last_answer_ < options_.silence) return std::nullopt;
  // In lockstep several ticks may come at one time.
  if (last_hold_ && now - *last_hold_ < options_.hold_period) return std::nullopt;
  last_hold_ = now;
  time_ = std::max(time_, now);
  command_.stamp = now;
  command_.origin.reset();
  command_.mode = Mode::hold;
  return command_;
}

}  // namespace prehend::mapping
