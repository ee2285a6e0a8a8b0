#include "services/robot/core/barrett_driver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace prehend::robot::barrett {
namespace {

using std::chrono::milliseconds;

constexpr std::array<const char*, motors> names{"finger 1", "finger 2", "finger 3", "spread"};

/// LCVC: a velocity's byte is sixteenths of so many counts/ms.
constexpr std::array<int, motors> coefficient{3, 3, 3, 1};
double counts_per_second(std::size_t motor) {
  return coefficient[motor] * 1000.0 / 16;
}
constexpr double press_speed = 0.4;  // rad/s, of a motor that is kept from moving
constexpr int max_strain = 240;      // above it nothing closes any more
constexpr double cool = 3;           // °C below the limit, after it was passed

constexpr Duration patience = milliseconds(1000);  // with an answer to a line, when it is there
constexpr std::size_t reply_bytes = 64;
constexpr Duration homing_patience = std::chrono::seconds(40);
constexpr Duration quiet = milliseconds(60);  // after which nothing more comes
constexpr Duration wake_period = milliseconds(100);
constexpr std::size_t wake_bytes = 24;  // there and back
constexpr double late = 0.55;           // of lost_after, that an answer may come too late
constexpr double max_gap = 0.03;        // s, after which a jump has to be seen twice
constexpr Duration heat_period = milliseconds(1000);
constexpr std::size_t max_heard = 4096;

/// What RealTime mode sends and receives: velocities in; strain, position and temperature out.
constexpr std::array settings{"1234FSET LCV 1 LCPG 0 LFV 0 LFS 1 LFAP 1 LFDP 0", "123FSET LCVC 3",
                              "4FSET LCVC 1", "PSET LFT 1"};

Duration time_on_line(std::size_t bytes, int baud) {
  return seconds(static_cast<double>(bytes) * 10 / baud);
}

/// Further no joint is after so many s.
double max_way(std::size_t motor, double s) {
  return (0.03 + 5.5 * s) * counts_per_radian(motor);
}

}  // namespace

Expected<std::unique_ptr<robot::Driver>> create(const model::HandModel& hand,
                                                const DriverOptions& options) {
  const auto& dofs = hand.dofs();
  if (dofs.size() != motors || hand.name() != "barrett")
    return wrong_use("'" + hand.name() + "' is no BarrettHand", "robot.hand", "give barrett");
  constexpr std::array bauds{600, 1200, 2400, 4800, 9600, 19200, 38400};
  if (std::find(bauds.begin(), bauds.end(), options.baud) == bauds.end())
    return wrong_use("is no rate of this hand", "robot.baud = " + std::to_string(options.baud),
                     "600, 1200, 2400, 4800, 9600, 19200 or 38400");
  return std::make_unique<Driver>(hand, options);
}

Driver::Driver(const model::HandModel& hand, const DriverOptions& options)
    : hand_(hand), options_(options) {
  for (std::size_t i = 0; i < motors; ++i) {
    const model::HandDof& dof = hand_.dofs()[dof_of[i]];
    const double scale = counts_per_radian(i);
    control_.emplace_back(MotorControl::Limits{
        .speed = std::min(1.2 * dof.max_velocity * scale, 127 * counts_per_second(i)),
        .press = press_speed * scale,
        .squeeze = dof.squeeze * scale,
        .counts_per_radian = scale});
  }
}

void Driver::connected(Time now) {
  talk_ = Talk::waking;
  heard_.clear();
  heard_at_ = asked_ = now - wake_period;
  if (phase_ == Phase::offline) trouble_ = "does not answer";
}

void Driver::disconnected(const std::string& why) {
  talk_ = Talk::silent;
  be(Phase::offline, why);
}

std::string Driver::step(std::string_view heard, Time now) {
  if (!heard.empty()) heard_at_ = now;
  heard_.append(heard);
  if (heard_.size() > max_heard) heard_.erase(0, heard_.size() - max_heard);
  switch (talk_) {
    case Talk::silent:
      heard_.clear();
      return {};
    case Talk::waking:
      return wake(now);
    case Talk::idle:
      return rest(now);
    case Talk::entering:
      return enter(now);
    case Talk::probing:
      return probe(now);
    case Talk::looping:
      return loop(now);
    default:
      return converse(now);
  }
}

void Driver::follow(const Eigen::VectorXd& dof, const Eigen::VectorXd& effort, Time now) {
  for (std::size_t i = 0; i < motors; ++i) {
    const auto d = static_cast<Eigen::Index>(dof_of[i]);
    const auto& joint = hand_.joints()[static_cast<std::size_t>(hand_.dofs()[dof_of[i]].joint)];
    const double share = effort.size() > d ? effort[d] / joint.max_torque : 1;
    const double counts = dof[d] * counts_per_radian(i);
    control_[i].follow(std::clamp(counts, 0.0, static_cast<double>(max_counts(i))), share, now);
  }
}

void Driver::home() {
  if (phase_ == Phase::configured || phase_ == Phase::ready) wants_home_ = true;
}

void Driver::hold() {
  wants_home_ = false;
  gives_up_ = talk_ == Talk::homing;
  for (MotorControl& motor : control_) motor.hold();
}

// --- supervisory mode

std::string Driver::ask(Talk talk, const std::string& line, Duration how_long, Time now) {
  talk_ = talk;
  line_ = line;
  heard_.clear();
  asked_ = now;
  patience_ = how_long + time_on_line(line.size() + reply_bytes, options_.baud);
  gives_up_ = false;
  return line + end_of_line;
}

/// Whatever the hand does is ended, and it is asked anew.
std::string Driver::interrupt(Time now) {
  talk_ = Talk::waking;
  heard_.clear();
  asked_ = heard_at_ = now;
  return std::string(abort_surely) + end_of_line;
}

/// Ends whatever the hand does, until it says nothing but the prompt.
std::string Driver::wake(Time now) {
  const bool prompted = heard_.find(prompt) != std::string::npos;
  if (prompted && now - heard_at_ > quiet) return ask(Talk::version, "VERS", patience, now);
  // Often, for until it hears this its motors run on.
  if (now - asked_ < wake_period + time_on_line(wake_bytes, options_.baud)) return {};
  asked_ = now;
  heard_.clear();
  return std::string(abort_surely) + end_of_line;
}

std::string Driver::converse(Time now) {
  if (std::exchange(gives_up_, false)) {
    be(Phase::configured, "homing was stopped");
    return interrupt(now);
  }
  const std::size_t end = heard_.rfind(prompt);
  if (end == std::string::npos) {
    if (now - asked_ > patience_) return lose("does not answer", now);
    return {};
  }
  Reply reply = parse_reply(std::string_view(heard_).substr(0, end));
  heard_.clear();
  // A hand that is set up for people at terminals says again what it was asked.
  if (!reply.lines.empty() && reply.lines.front() == line_) reply.lines.erase(reply.lines.begin());
  return answered(reply, now);
}

std::string Driver::answered(const Reply& reply, Time now) {
  switch (talk_) {
    case Talk::version:
      identity_ = reply.lines.empty() ? "a hand that does not say its version" : reply.lines[0];
      return ask(Talk::status, "1234FGET S", patience, now);
    case Talk::status:
      return judge_status(reply, now);
    case Talk::heat:
      return judge_heat(reply, now);
    case Talk::homing:
      if (reply.error != 0) {
        be(Phase::faulted, "homing: " + explain(reply.error));
        talk_ = Talk::idle;
        asked_ = now;
        return {};
      }
      return ask(Talk::status, "1234FGET S", patience, now);
    case Talk::setting:
      if (reply.error != 0)
        return lose(fmt::format("refuses {}: {}", settings[setting_], explain(reply.error)), now);
      ++setting_;
      return next_setting(now);
    case Talk::position: {
      const auto counts = numbers(reply);
      if (!counts || counts->size() != motors) return lose("says no positions", now);
      return ask(Talk::entering, "1234LOOP", patience, now);
    }
    default:
      return {};
  }
}

std::string Driver::judge_status(const Reply& reply, Time now) {
  const auto states = numbers(reply);
  if (reply.error != 0 || !states || states->size() != motors)
    return lose(reply.error != 0 ? explain(reply.error) : "says no status", now);
  int worst = 0;
  for (const int state : *states) worst |= state;
  if ((worst & ~(not_initialized | position_not_reached | aborted)) != 0)
    return lose(explain(worst), now);
  // That a finger did not get to where it was sent is no fault of the hand.
  is_homed_ = (worst & not_initialized) == 0;
  return ask(Talk::heat, "PGET TEMP", patience, now);
}

std::string Driver::judge_heat(const Reply& reply, Time now) {
  const auto values = numbers(reply);
  if (reply.error != 0 || !values || values->size() != 1)
    return lose(reply.error != 0 ? explain(reply.error) : "says no temperature", now);
  temperature_ = values->front() / 10.0;
  hot_ = *temperature_ > options_.max_temperature - (hot_ ? cool : 0);
  if (hot_)
    be(Phase::faulted, too_hot());
  else
    be(is_homed_ && !wants_home_ ? Phase::homed : Phase::configured);
  setting_ = 0;
  if (phase_ == Phase::homed) return next_setting(now);
  talk_ = Talk::idle;
  asked_ = now;
  return {};
}

std::string Driver::too_hot() const {
  return fmt::format("too hot: {:.1f} °C, of at most {:.1f} °C", *temperature_,
                     options_.max_temperature);
}

/// Nothing is to be done until it is homed, or has cooled down.
std::string Driver::rest(Time now) {
  if (std::exchange(wants_home_, false) && phase_ == Phase::configured) {
    be(Phase::homing);
    return ask(Talk::homing, "HI", homing_patience, now);
  }
  if (now - asked_ < heat_period) return {};
  return ask(Talk::status, "1234FGET S", patience, now);
}

// --- RealTime mode

std::string Driver::next_setting(Time now) {
  if (setting_ < settings.size()) return ask(Talk::setting, settings[setting_], patience, now);
  return ask(Talk::position, "1234FGET P", patience, now);
}

std::string Driver::enter(Time now) {
  if (heard_.find(prompt) != std::string::npos)
    return lose("refuses RealTime mode: " + explain(parse_reply(heard_).error), now);
  const bool quiet_now = now - heard_at_ > quiet;  // a line's end may come after it
  if (quiet_now && heard_.find(acknowledgement) != std::string::npos) {
    talk_ = Talk::probing;
    heard_.clear();
    asked_ = now;
    return "A";  // a block that changes nothing
  }
  if (now - asked_ > patience_) return lose("does not enter RealTime mode", now);
  return {};
}

/// Firmware differs in how long the temperature is: the first block tells.
std::string Driver::probe(Time now) {
  const std::size_t longest = 1 + feedback_size(2);
  const bool over = heard_.size() >= longest || (!heard_.empty() && now - heard_at_ > quiet);
  if (over && heard_.size() >= 1 + feedback_size(0)) {
    temperature_bytes_ = static_cast<int>(heard_.size() - 1 - feedback_size(0));
    const auto feedback = decode(std::string_view(heard_).substr(1), temperature_bytes_);
    if (heard_[0] != acknowledgement || !feedback) return lose("its feedback is nonsense", now);
    if (temperature_bytes_ == 0) temperature_.reset();  // what it was is soon no more true
    talk_ = Talk::looping;
    heard_.clear();
    waiting_ = false;
    deaf_until_ = now;
    phase_ = Phase::ready;
    silence_.end(now - milliseconds(1));
    for (MotorControl& motor : control_) motor.forget();
    accept(*feedback, now);  // each target is where its motor is
    return {};
  }
  if (now - asked_ > patience_ || over) return lose("sends no feedback", now);
  return {};
}

std::string Driver::loop(Time now) {
  silence_.listen(now);
  if (wants_home_) {
    phase_ = Phase::configured;
    return interrupt(now);
  }
  // An error ends RealTime mode: the hand says so and waits for lines again.
  if (heard_.find("ERR ") != std::string::npos && heard_.ends_with(prompt))
    return lose(explain(parse_reply(heard_).error), now);
  if (now < deaf_until_) {
    heard_.clear();
  } else if (waiting_ && !take_block(now)) {
    Duration due = milliseconds(40) + 2 * time_on_line(5 + 1 + feedback_size(2), options_.baud);
    if (standing_) due = std::max(due, options_.lost_after / 4);
    if (now - asked_ > due && now - heard_at_ > quiet / 2)
      return heard_.empty() ? miss(now) : (reject("garbled answer", now), std::string());
  }
  if (now - silence_.began() > options_.lost_after) return lose(silence_.words(now), now);
  for (std::size_t i = 0; i < motors; ++i)
    if (control_[i].stuck()) return lose(std::string(names[i]) + " is stuck", now);
  if (temperature_ && *temperature_ > options_.max_temperature) return lose(too_hot(), now);
  return now < deaf_until_ ? std::string() : exchange_block(now);
}

/// An answer that comes too late would be taken for the one to the next question, and say where the
/// hand was. So its motors stand still until one comes in time, and nothing is asked until none can
/// come too late any more. Of motors that stand still a late answer tells nothing wrong.
std::string Driver::miss(Time now) {
  reject("no answer", now);
  if (standing_) return {};
  deaf_until_ = now + seconds(late * to_seconds(options_.lost_after));
  standing_ = true;
  for (MotorControl& motor : control_) motor.rest();
  return control_block({});
}

std::string Driver::exchange_block(Time now) {
  if (waiting_ || now - asked_ < seconds(1 / options_.rate)) return {};
  std::array<std::int8_t, motors> velocity{};
  for (std::size_t i = 0; i < motors && !standing_; ++i) {
    const double unit = std::clamp(control_[i].command(now) / counts_per_second(i), -127.0, 127.0);
    velocity[i] = static_cast<std::int8_t>(std::lround(unit));
  }
  waiting_ = true;
  asked_ = now;
  heard_.clear();
  return control_block(velocity);
}

/// True when the answer was there, sound or not.
bool Driver::take_block(Time now) {
  const std::size_t size = 1 + feedback_size(temperature_bytes_);
  if (heard_.size() < size || heard_[0] != acknowledgement) return false;
  const auto feedback = decode(std::string_view(heard_).substr(1), temperature_bytes_);
  if (heard_.size() > size || !feedback) return false;
  if (!plausible(*feedback, now) && !is_confirmed(*feedback)) return false;
  heard_.clear();
  waiting_ = false;
  accept(*feedback, now);
  return true;
}

/// No joint is faster than its motor. A block has no sum, so what bytes that changed places say is
/// not believed the more the longer nothing sound has come.
bool Driver::plausible(const Feedback& feedback, Time now) const {
  const double dt = std::min(to_seconds(now - silence_.began()), max_gap);
  for (std::size_t i = 0; i < motors; ++i)
    if (std::abs(feedback.position[i] - control_[i].position()) > max_way(i, dt)) return false;
  return true;
}

/// The answer before has said nearly the same.
bool Driver::is_confirmed(const Feedback& feedback) {
  doubted_ = feedback;
  if (!doubted_before_) return false;
  for (std::size_t i = 0; i < motors; ++i)
    if (std::abs(feedback.position[i] - doubted_before_->position[i]) > max_way(i, max_gap))
      return false;
  return true;
}

void Driver::reject(const char* why, Time now) {
  count_reject(why);
  heard_.clear();
  waiting_ = false;
  doubted_before_ = std::exchange(doubted_, std::nullopt);
  asked_ = now - seconds(1 / options_.rate);
}

void Driver::accept(const Feedback& feedback, Time now) {
  for (std::size_t i = 0; i < motors; ++i) {
    control_[i].observe(feedback.position[i], now);
    if (i < 3 && feedback.strain[i] != no_gauge && feedback.strain[i] > max_strain)
      control_[i].close_no_further();
  }
  if (feedback.temperature) temperature_ = feedback.temperature;
  doubted_.reset();
  doubted_before_.reset();
  standing_ = false;
  silence_.end(now);
  publish(now);
}

void Driver::publish(Time now) {
  Reading reading{now, Eigen::VectorXd(motors), Eigen::VectorXd(motors), Eigen::VectorXd(motors),
                  temperature_};
  for (std::size_t i = 0; i < motors; ++i) {
    const auto d = static_cast<Eigen::Index>(dof_of[i]);
    const auto& joint = hand_.joints()[static_cast<std::size_t>(hand_.dofs()[dof_of[i]].joint)];
    reading.dof[d] = control_[i].position() / counts_per_radian(i);
    reading.velocity[d] = control_[i].velocity() / counts_per_radian(i);
    reading.effort[d] = control_[i].effort() * joint.max_torque;
  }
  reading_ = std::move(reading);
}

/// Something is wrong.
std::string Driver::lose(const std::string& why, Time now) {
  be(Phase::faulted, why);
  wants_home_ = false;
  return interrupt(now);
}

}  // namespace prehend::robot::barrett
