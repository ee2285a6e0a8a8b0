#include "services/mapping/core/mapping.hpp"

#include <algorithm>
#include <utility>

#include "common/model/human_hand.hpp"
#include "common/model/past_contact.hpp"

namespace prehend::mapping {

namespace {

// A robot hand that has been silent for longer may have been started anew.
constexpr Duration max_state_pause = std::chrono::milliseconds(500);
// It is not where it was told to be, m and rad: it lags behind by less, and what a finger touches
// stops it nearer.
constexpr double elsewhere = 0.05, turned_elsewhere = 0.2, fingers_elsewhere = 0.5;

/// A finger of a hand at X_WB with this posture reaches into the object.
bool closes_on(const FingerDistances& fingers, const Eigen::VectorXd& dof, const Pose& X_WB,
               const Detection& object) {
  const Eigen::VectorXd distances =
      fingers.distances(dof, object.shape, X_WB.inverse() * object.X_WO);
  return distances.minCoeff() < 0.002;
}

}  // namespace

Expected<Mapping> Mapping::create(const model::HandModel& hand, const MappingModel& model,
                                  const MappingOptions& options) {
  Mapping made(hand, model, options);
  if (auto used = made.use(options.modes); !used) return tl::unexpected(used.error());
  return made;
}

Mapping::Mapping(const model::HandModel& hand, const MappingModel& model,
                 const MappingOptions& options)
    : hand_(hand),
      model_(model),
      options_(options),
      distances_(hand),
      tracks_(options.tracks),
      targets_(hand, model, options.target),
      arbitration_(options.ramp),
      trust_(options.trust, options.ramp),
      direct_(hand, options.ramp),
      placement_(hand, options.placement),
      clutch_(hand, options.clutch),
      follow_through_(hand),
      grip_(hand, options.grip),
      motion_(hand, options.motion),
      others_(hand),
      hold_(options.hold) {}

Expected<void> Mapping::use(const MappingModes& modes) {
  if (auto used = direct_.use(modes.fingers); !used) return used;
  options_.modes = modes;
  return {};
}

Expected<void> Mapping::on_state(const RobotState& state) {
  const auto dofs = static_cast<Eigen::Index>(hand_.dofs().size());
  const auto joints = static_cast<Eigen::Index>(hand_.joints().size());
  if (state.dof.size() != dofs || state.velocity.size() != joints || state.torque.size() != joints)
    return fail("robot state of another hand");
  if (!state.dof.allFinite() || !state.velocity.allFinite() || !state.torque.allFinite() ||
      !is_finite(state.X_WB))
    return fail("robot state not finite");
  // One that was started anew is somewhere else: what it was told before does not count.
  const bool returns = state_ && (std::chrono::abs(state.stamp - state_->stamp) > max_state_pause ||
                                  clutch_.is_jump(state_->X_WB, state.X_WB));
  grip_.observe(state, command_.dof);
  state_ = state;
  if (command_.dof.size() > 0 && (returns || !obeyed_)) take_place_of_robot();
  return {};
}

void Mapping::on_gate(bool obeys, std::optional<bool> placed) {
  if (obeys != obeyed_) interrupted_ = true;
  obeyed_ = obeys;
  placed_ = placed;
}

/// Have fingers become so different that they would sweep from one posture to the other?
bool Mapping::are_apart(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const {
  for (std::size_t i = 0; i < hand_.dofs().size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (std::abs(a[k] - b[k]) > fingers_elsewhere * radian_of(hand_.dofs()[i])) return true;
  }
  return false;
}

bool Mapping::robot_is_elsewhere() const {
  if (!state_ || command_.dof.size() == 0) return false;
  return are_apart(state_->dof, command_.dof) ||
         (state_->X_WB.translation() - command_.X_WB.translation()).norm() > elsewhere ||
         angle_between(state_->X_WB.linear(), command_.X_WB.linear()) > turned_elsewhere;
}

/// The next command counts from where the robot hand is, unless that is where it was told to be.
void Mapping::take_place_of_robot() {
  if (!robot_is_elsewhere()) return;
  interrupted_ = true;
  command_.dof = grip_.squeeze(hand_.clamp(state_->dof));
  command_.X_WB = state_->X_WB;
}

Expected<Command> Mapping::on_posture(const Posture& posture, Time now) {
  const auto features = features_of(posture, now);
  if (!features) return tl::unexpected(features.error());
  const Pose X_WG_human = posture.X_WH * model::HumanHand(posture.hand_scale).X_HG();
  if (command_.dof.size() == 0 && !start(X_WG_human, posture.stamp, now))
    return fail("no robot state yet");
  const Duration elapsed = motion_.step(posture.stamp - time_);
  const Pose X_WG = clutch(X_WG_human, elapsed);
  time_ = std::max(time_, posture.stamp);

  const auto seen = select_target(X_WG, posture.stamp);
  weigh(seen, elapsed);
  const auto fingers = answer(posture, *features, elapsed);
  if (!fingers) return tl::unexpected(fingers.error());
  const GraspType grasp =
      grasp_type(mean_closing(hand_, fingers->dof), X_WG, model_.is_precision(*features));
  place(X_WG, seen, elapsed);
  const Eigen::VectorXd dof = grip_.squeeze(follow_through(fingers->dof, elapsed));
  const bool paused = posture.stamp - last_stamp_ > options_.clutch.max_pause;
  if (interrupted_ || (paused && last_X_WG_ && are_apart(dof, command_.dof)))
    clutch_.hold(dof, command_.dof);
  interrupted_ = !obeyed_;
  last_X_WG_ = X_WG_human;
  last_stamp_ = std::max(last_stamp_, posture.stamp);
  move_toward(clutch_.dof(dof), placement_.X_WB(X_WG), elapsed);

  command_.stamp = posture.stamp;
  command_.origin = posture.origin;
  command_.mode = known_object() != nullptr ? Mode::intelligent : Mode::direct;
  command_.weight = weight();
  command_.object = known_object() != nullptr ? known_object()->object.detection.name : "";
  command_.grasp_type = grasp;
  command_.extrapolating = fingers->extrapolating;
  hold_.answered(now);
  return command_;
}

/// What is seen of a posture that can be answered.
Expected<Features> Mapping::features_of(const Posture& posture, Time now) const {
  auto features = mapping::features(posture.fingertips, posture.hand_scale);
  if (!features) return features;
  if (!is_finite(posture.X_WH)) return fail("pose of the hand not finite");
  if (std::chrono::abs(now - posture.stamp) > options_.max_posture_age)
    return fail("posture stale");
  return features;
}

/// Where the first command begins: where the robot hand is; without word from it, where it shall
/// be. False: not yet.
bool Mapping::start(const Pose& X_WG, Time stamp, Time now) {
  if (!first_posture_) first_posture_ = now;
  const bool told = state_ && (placed_ || !options_.start_slowly);
  if (!told && now - *first_posture_ < options_.state_wait) return false;
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
  if (grip_.touching()) placement_.start(X_WG, state_->X_WB);
  // One without a gate may be somewhere, too.
  if (options_.start_slowly && placed_.value_or(true)) interrupted_ = true;
  return true;
}

/// What the human hand stands for: itself, unless there was an interruption.
Pose Mapping::clutch(const Pose& X_WG, Duration elapsed) {
  clutch_.fade(elapsed);
  if (last_X_WG_ && clutch_.is_jump(*last_X_WG_, X_WG)) interrupted_ = true;
  if (interrupted_) clutch_.hold(X_WG, placement_.X_WG(command_.X_WB));
  return clutch_.X_WG(X_WG);
}

/// The object to reach for, as it is seen now.
std::optional<GraspTarget> Mapping::select_target(const Pose& X_WG, Time now) {
  if (!options_.modes.intelligent && !options_.modes.placement) return std::nullopt;
  tracks_.forget_old(now);
  return targets_.select(tracks_, planned_, X_WG);
}

/// Moves the weight of the intelligent answer.
void Mapping::weigh(const std::optional<GraspTarget>& seen, Duration elapsed) {
  const Phase before = arbitration_.phase();
  arbitration_.step(seen.has_value(), grip_.touching(), elapsed);
  targets_.update(seen, before, arbitration_.phase());
  trust_.step(seen ? &seen->object : nullptr, arbitration_.phase(), elapsed);
}

const GraspTarget* Mapping::known_object() const {
  return targets_.engaged() && weight() > 0 ? &*targets_.engaged() : nullptr;
}

/// The fingers' answer: the direct one, and by its weight that of the object's network.
Expected<NetworkAnswer> Mapping::answer(const Posture& posture, const Features& features,
                                        Duration elapsed) {
  const NetworkAnswer joints = model_.direct(features);
  auto direct = direct_.answer(posture, joints.dof, command_.dof, command_.grasp_type, elapsed);
  if (!direct) return tl::unexpected(direct.error());
  NetworkAnswer made{std::move(*direct), joints.extrapolating};
  const GraspTarget* target = known_object();
  if (target != nullptr && options_.modes.intelligent) {
    const NetworkAnswer known = known_answer(features, *target);
    made.dof += weight() * (known.dof - made.dof);
    made.extrapolating = known.extrapolating || (joints.extrapolating && weight() < 1);
  }
  made.dof = limited(made.dof);
  return made;
}

/// Within what the model was trained to, or, where an answer was planned, what the hand can.
Eigen::VectorXd Mapping::limited(const Eigen::VectorXd& dof) const {
  const GraspTarget* target = known_object();
  const bool planned = options_.modes.intelligent && target != nullptr && target->planned;
  return planned ? hand_.clamp(dof) : model_.limited(dof);
}

/// What is right for the object: as it was planned, as far as the person has closed, or else its
/// network's answer.
NetworkAnswer Mapping::known_answer(const Features& features, const GraspTarget& target) const {
  const model::Shape& shape = target.object.detection.shape;
  // select() lets through only what is planned and shapes that have a network.
  if (!target.planned) return *model_.intelligent(features, shape, target.X_OG);
  const model::GraspCandidate& grasp = *target.planned;
  const ClosingAnswer closed = *model_.closing(features, shape, target.X_OG);
  Eigen::VectorXd end = grasp.dof;
  for (Eigen::Index i = 0; i < end.size(); ++i)
    end[i] += grasp.closing[i] * hand_.dofs()[static_cast<std::size_t>(i)].squeeze;
  end = hand_.clamp(end);
  // Whoever has closed nearly as far as it takes wants to hold it.
  constexpr double nearly = 0.8;
  const double share = std::min(1.0, closed.share / nearly);
  return {grasp.preshape + share * (end - grasp.preshape), closed.extrapolating};
}

/// Corrects where the hand goes.
void Mapping::place(const Pose& X_WG, const std::optional<GraspTarget>& seen, Duration elapsed) {
  // In a grip, the object moves with the hand: what was corrected stays.
  if (phase() == Phase::gripping) return;
  if (phase() == Phase::direct || !options_.modes.placement) {
    placement_.release();
  } else if (seen && phase() != Phase::leaving) {
    // Planned fingers arrive together.
    if (options_.modes.intelligent && !seen->planned)
      placement_.yield(*seen, targets_.engaged()->object.detection, distances_, command_.dof);
    placement_.aim(X_WG, *seen);
  }
  placement_.follow(weight(), elapsed);
}

/// Fingers that have closed on an object whose answer counts fully go on.
Eigen::VectorXd Mapping::follow_through(const Eigen::VectorXd& dof, Duration elapsed) {
  const GraspTarget* target = known_object();
  if (target == nullptr || !options_.modes.intelligent || weight() <= 0.99) {
    follow_through_.reset();
    return dof;
  }
  const bool closed = closes_on(distances_, dof, command_.X_WB, target->object.detection);
  const double most =
      target->planned ? target->planned->follow_through : model::full_follow_through;
  return limited(follow_through_.go_on(dof, closed, grip_.touching(), elapsed, most));
}

/// As far as the hand may go in this time.
void Mapping::move_toward(const Eigen::VectorXd& dof, const Pose& X_WB, Duration elapsed) {
  const double together = options_.modes.intelligent ? weight() : 0;
  command_.dof = motion_.fingers(command_.dof, limited(dof), together, elapsed);
  const Pose before = command_.X_WB;
  command_.X_WB = motion_.base(before, X_WB, elapsed);
  if (others_.empty()) return;
  // Past another hand it may be pushed further than it may go.
  const Pose beside = others_.go(before, command_.X_WB, command_.dof);
  command_.X_WB = motion_.base(before, beside, elapsed);
}

std::optional<Command> Mapping::tick(Time now) {
  if (!hold_.due(now)) return std::nullopt;
  time_ = std::max(time_, now);
  command_.stamp = now;
  command_.origin.reset();
  command_.mode = Mode::hold;
  return command_;
}

}  // namespace prehend::mapping
