#include "services/robot/service/service.hpp"

#include <fmt/format.h>

#include <utility>

#include "common/base/log.hpp"
#include "common/dds/topics.hpp"
#include "common/serial/overheard.hpp"
#include "services/robot/service/messages.hpp"

namespace prehend::robot {
namespace {

constexpr Duration tick = std::chrono::milliseconds(2);
/// Commands begin where the hand says it is. Before the first nobody knows that; this is above the
/// near edge of the table, where nothing stands.
const Eigen::Vector3d resting_place_W(0, -0.4, 0.6);
constexpr Duration stale = std::chrono::milliseconds(200);  // without commands: it holds still

/// What the lab is told of a robot that does not follow.
std::string advice(Phase phase, const std::string& trouble) {
  switch (phase) {
    case Phase::configured:
      return "configured, " + (trouble.empty() ? "not homed" : trouble) +
             "; prehend robot home, or robot.home = true";
    case Phase::ready:
      return {};
    default:
      return std::string(to_string(phase)) + (trouble.empty() ? "" : ": " + trouble);
  }
}

}  // namespace

Expected<std::unique_ptr<Service>> Service::create(service::Shell& shell) {
  if (shell.lockstep())
    return wrong_use("a robot cannot wait for the others", "lab.lockstep",
                     "set it to false, or start prehend-simulation in its place");
  auto connection = connection_of(shell.config());
  if (!connection) return tl::unexpected(connection.error());
  std::unique_ptr<Service> made(new Service(shell, std::move(*connection)));
  if (auto started = made->start(); !started) return tl::unexpected(started.error());
  return made;
}

Service::Service(service::Shell& shell, Connection connection)
    : shell_(shell),
      connection_(std::move(connection)),
      driver_(*connection_.driver),
      line_(driver_, connection_.open),
      states_(shell.publish(dds::robot_state)),
      touches_(shell.publish(dds::robot_touch)),
      hand_name_(shell.config().text("robot.hand_name")),
      homes_(shell.config().flag("robot.home")),
      X_WB_(make_pose(resting_place_W)) {}

Expected<void> Service::start() {
  Robot robot;
  robot.obey = [this](const v2::HandCommand& command, const gate::Place& place, Time now) {
    return obey(command, place, now);
  };
  robot.where = [this] { return where(); };
  robot.hold = [this] { driver_.hold(); };
  robot.is_placed = [this] { return placed_ && driver_.reading().has_value(); };
  robot.is_real = true;  // what speaks at the end of a wire cannot be seen from here
  robot.go = [this](const gate::Place& place, Time now) {
    if (phase_ == Phase::ready) driver_.follow(place.dof, place.effort, now);
  };
  auto gate = Gatekeeper::create(shell_, *connection_.hand, hand_name_, std::move(robot));
  if (!gate) return tl::unexpected(gate.error());
  gate_ = std::move(*gate);
  shell_.on_tick(tick, [this](Time now) { on_tick(now); });
  shell_.status().running();
  shell_.status().note("offline: " + connection_.port);
  return {};
}

Expected<void> Service::obey(const v2::HandCommand& command, const gate::Place& place, Time now) {
  X_WB_ = place.X_WB;
  const bool was_placed = std::exchange(placed_, true);
  if (phase_ != Phase::ready) return fail("the robot is not ready", std::string(to_string(phase_)));
  // The gate did not know where the joints were, so they might jump to where it let them go.
  if (was_placed)
    driver_.follow(place.dof, place.effort, now);
  else
    gate_->start_anew();
  holds_ = false;
  obeyed_ = now;
  origin_ns_ = command.origin_ns();
  return {};
}

/// Before any command nobody knows where the hand is carried.
std::optional<gate::Place> Service::where() const {
  if (!placed_ || !driver_.reading()) return std::nullopt;
  return gate::Place{connection_.hand->clamp(driver_.reading()->dof), X_WB_};
}

void Service::on_tick(Time now) {
  line_.exchange(now);
  for (const std::string& reject : driver_.take_rejects()) shell_.status().drop(reject);
  watch(now);
  if (!holds_ && now - obeyed_ > stale) {
    holds_ = true;
    driver_.hold();
  }
  gate_->tick(now);
  publish();
}

void Service::watch(Time now) {
  const Phase phase = driver_.phase();
  if (phase == Phase::configured && homes_ && gate_->may_move(now)) driver_.home();
  std::string trouble = line_.trouble().message();
  if (phase == phase_ && !serial::is_news(trouble, trouble_)) return;
  const bool was_ready = std::exchange(phase_, phase) == Phase::ready;
  trouble_ = std::move(trouble);
  const std::string says = advice(phase, trouble_);
  if (phase == Phase::ready) {
    log::info("{} is ready", driver_.identity());
    gate_->start_anew();
  } else {
    log::warning("{}: {}", connection_.port, says);
  }
  shell_.status().note(says);
  if (!was_ready) return;
  holds_ = true;
  gate_->fault(says, now);
}

void Service::publish() {
  const auto& reading = driver_.reading();
  if (!reading || reading->stamp == published_) return;
  published_ = reading->stamp;
  shell_.status().count("readings");
  v1::HandState state = to_message(*reading, *connection_.hand, X_WB_);
  state.hand(hand_name_);
  state.sequence_number(sequence_++);
  state.origin_ns(origin_ns_);
  states_.publish(state);
  v1::HandTouch touch = touch_to_message(*reading, *connection_.hand);
  touch.hand(hand_name_);
  touch.sequence_number(state.sequence_number());
  touch.origin_ns(origin_ns_);
  touches_.publish(touch);
}

}  // namespace prehend::robot
