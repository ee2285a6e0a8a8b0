#include "services/robot/core/inspire_driver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/model/hand_effort.hpp"

namespace prehend::robot::inspire {
namespace {

using std::chrono::milliseconds;

constexpr Duration pause = milliseconds(1);
constexpr Duration tells_again = milliseconds(1000);  // it may have been switched off and on
constexpr double smoothing = 0.05;                    // s, of velocities
constexpr double approach = 8;           // 1/s: how fast it goes to a goal that is so far away
constexpr int slowest = 25;              // of its speed: then it hardly passes its force limit
constexpr int near = 20;                 // counts: there
constexpr int far = 330;                 // counts: more than that off for long is stuck
constexpr int margin = 60;               // counts, that an angle may be past its range
constexpr double faster = 3;             // than at full speed no finger is
constexpr double cool = 3;               // °C below the limit, after it was passed
constexpr std::size_t frame_bytes = 48;  // there and back

constexpr std::array blocks{table::error, table::status, table::temperature, table::force_now};
constexpr std::array told_blocks{table::force_set, table::speed_set, table::angle_set};

}  // namespace

Expected<std::unique_ptr<robot::Driver>> create(const model::HandModel& hand,
                                                const DriverOptions& options) {
  if (auto fits = check_hand(hand); !fits) return tl::unexpected(fits.error());
  return std::make_unique<Driver>(hand, options);
}

Driver::Driver(const model::HandModel& hand, const DriverOptions& options)
    : PolledDriver(hand, options, {pause, patience_for(frame_bytes, options.baud)}),
      id_(options.id == 0 ? usual_id : static_cast<std::uint8_t>(options.id)) {
  wanted_[force].fill(full);
  wanted_[speed].fill(slowest);
  wanted_[angle].fill(leave);
}

void Driver::begin(Time now) {
  angle_.reset();
  force_.reset();
  error_.reset();
  status_.reset();
  temperature_.reset();
  told_at_.fill({});
  next_block_ = 0;
  reads_angle_ = clears_ = false;
  cleared_ = {};
  read_ = now - seconds(1 / options_.rate);
}

// --- what it shall do

/// Its encoders are absolute.
void Driver::home() {
  if (phase_ == Phase::ready) be(Phase::homing);
}

void Driver::follow(const Eigen::VectorXd& dof, const Eigen::VectorXd& effort, Time) {
  if (phase_ != Phase::ready) return;
  commanded_ = true;
  const Eigen::VectorXd most = model::max_effort(hand_);
  for (std::size_t i = 0; i < motors; ++i) {
    const auto d = static_cast<Eigen::Index>(i);
    const double share = effort.size() > d ? std::clamp(effort[d] / most[d], 0.0, 1.0) : 1;
    wanted_[force][i] = static_cast<int>(std::lround(full * share));
    wanted_[angle][i] = static_cast<int>(std::lround(count_of(hand_.dofs()[i], dof[d])));
  }
}

void Driver::hold() {
  if (phase_ == Phase::homing) be(Phase::ready);
  if (phase_ == Phase::ready) wanted_[angle] = halt();
}

std::string Driver::stay() {
  if (!angle_ || !commanded_) return {};
  return encode(Side::asks, {id_, Command::write, table::angle_set.address,
                             bytes_of(table::angle_set, halt())});
}

bool Driver::presses(std::size_t motor) const {
  if (!status_) return false;
  const int status = (*status_)[motor];
  return status == at_force || status == at_current || status == stalled;
}

/// All stay where they are; what presses keeps pressing.
Values Driver::halt() const {
  Values goals{};
  for (std::size_t i = 0; i < motors; ++i)
    goals[i] = presses(i) ? pressing(i) : std::clamp((*angle_)[i], 0, open_count);
  return goals;
}

/// No further ahead than it presses: what gave way would let it go to where it was led before.
int Driver::pressing(std::size_t motor) const {
  const int goal = wanted_[angle][motor];
  if (goal == leave) return leave;
  const model::HandDof& dof = hand_.dofs()[motor];
  const double squeeze = std::abs(open_count * dof.squeeze / (dof.upper - dof.lower));
  const int ahead = static_cast<int>(std::ceil(squeeze)), here = (*angle_)[motor];
  return std::clamp(std::clamp(goal, here - ahead, here + ahead), 0, open_count);
}

/// In steps, so that it need not be told each time.
int Driver::speed_to(std::size_t motor, int goal) const {
  if (goal == leave) return slowest;
  const double fastest = open_count / fastest_stroke;
  const double wished = approach * std::abs(goal - (*angle_)[motor]);
  int step = slowest;
  while (step < full && step < full * wished / fastest) step *= 2;
  return std::min(step, full);
}

// --- the conversation

std::string Driver::question(Time now) {
  if (clears_) {
    clears_ = false;
    question_ = {id_, Command::write, table::clear_error, "\1"};
    return encode(Side::asks, question_);
  }
  const bool known = angle_ && error_ && status_ && temperature_;
  if (known && (phase_ == Phase::ready || phase_ == Phase::faulted))
    if (auto said = next_told(now)) return *said;
  if (known && reads_angle_ && now - read_ < seconds(1 / options_.rate)) return {};
  reads_angle_ = !reads_angle_;
  if (!reads_angle_) return ask(blocks[next_block_++ % blocks.size()]);
  read_ = now;
  return ask(table::angle_now);
}

std::string Driver::ask(const Block& block) {
  question_ = {id_, Command::read, block.address, std::string(1, static_cast<char>(block.bytes()))};
  return encode(Side::asks, question_);
}

/// What it has not taken yet, or long ago. Between two of them an angle is read.
std::optional<std::string> Driver::next_told(Time now) {
  if (question_.command == Command::write || !commanded_) return std::nullopt;
  for (std::size_t i = 0; i < motors; ++i) wanted_[speed][i] = speed_to(i, wanted_[angle][i]);
  for (std::size_t n = 0; n < told_count; ++n) {
    const std::size_t what = (telling_ + 1 + n) % told_count;
    if (told_[what] == wanted_[what] && now - told_at_[what] < tells_again) continue;
    return tell(what, now);
  }
  return std::nullopt;
}

std::string Driver::tell(std::size_t what, Time) {
  telling_ = what;
  told_[what] = wanted_[what];
  told_at_[what] = {};  // until it says that it took them
  question_ = {id_, Command::write, told_blocks[what].address,
               bytes_of(told_blocks[what], wanted_[what])};
  return encode(Side::asks, question_);
}

PolledDriver::Heard Driver::hear(Time now) {
  const auto frame = parser_.next();
  for (int n = parser_.take_broken(); n > 0; --n) count_reject("garbled answer");
  if (!frame) return Heard::nothing;
  if (is_of_another(id_, frame->id)) return Heard::foreign;
  if (frame->command != question_.command || frame->address != question_.address) {
    count_reject("answer to another question");
    return Heard::foreign;
  }
  if (take(*frame, now)) return Heard::answer;
  count_reject("garbled answer");
  return Heard::foreign;
}

bool Driver::take(const Frame& answer, Time now) {
  if (question_.command == Command::write) {
    if (answer.data != "\1") return false;
    if (question_.address != table::clear_error) told_at_[telling_] = now;
    return true;
  }
  const Block& block =
      reads_angle_ ? table::angle_now : blocks[(next_block_ + blocks.size() - 1) % blocks.size()];
  const auto values = values_of(block, answer.data);
  return values && take_values(*values, now);
}

bool Driver::take_values(const Values& values, Time now) {
  if (reads_angle_) {
    if (!is_plausible(values, now)) return false;
    observe(values, now);
  } else {
    std::optional<Values>* const kept[] = {&error_, &status_, &temperature_, &force_};
    *kept[(next_block_ + blocks.size() - 1) % blocks.size()] = values;
  }
  identity_ = fmt::format("Inspire RH56, id {}", id_);
  judge(now);
  return true;
}

// --- what it says

/// Its sums are but a byte, so some damage gets past them.
bool Driver::is_plausible(const Values& angles, Time now) const {
  const double way = margin + faster * open_count / fastest_stroke * to_seconds(now - angles_at_);
  for (std::size_t i = 0; i < motors; ++i) {
    if (angles[i] < -margin || angles[i] > open_count + margin) return false;
    if (angle_ && std::abs(angles[i] - (*angle_)[i]) > way) return false;
  }
  return true;
}

void Driver::observe(const Values& angles, Time now) {
  const double dt = angle_ ? to_seconds(now - angles_at_) : 0;
  for (std::size_t i = 0; i < motors; ++i) {
    const int moved = angle_ ? angles[i] - (*angle_)[i] : 0;
    if (dt > 0) velocity_[i] += (moved - velocity_[i] * dt) / (dt + smoothing);
    const int goal = wanted_[angle][i];
    kept_[i].observe(
        !angle_ || moved != 0 || presses(i) || goal == leave || std::abs(goal - angles[i]) < near,
        now);
  }
  angle_ = angles;
  angles_at_ = now;
}

void Driver::judge(Time now) {
  if (!angle_ || !error_ || !status_ || !temperature_) return;
  for (std::size_t i = 0; i < motors; ++i) {
    if ((*error_)[i] == 0) continue;
    // What has passed is forgotten when the hand is told so; what has not is said again.
    if (now - cleared_ > tells_again) {
      clears_ = true;
      cleared_ = now;
    }
    return fault(std::string(dof_names[i]) + " " + explain_error((*error_)[i]));
  }
  cleared_ = {};
  const int hottest = *std::max_element(temperature_->begin(), temperature_->end());
  is_hot_ = hottest > options_.max_temperature - (is_hot_ ? cool : 0);
  if (is_hot_)
    return fault(
        fmt::format("too hot: {} °C, of at most {:.0f} °C", hottest, options_.max_temperature));
  const bool anew = phase_ != Phase::ready;
  if (anew) become_ready();
  if (anew || reads_angle_) publish(now);
}

void Driver::fault(const std::string& why) {
  if (phase_ == Phase::ready) wanted_[angle] = halt();
  be(Phase::faulted, why);
}

/// It stays where it is until it is told where to go. Of one that was led before this must be said.
void Driver::become_ready() {
  be(Phase::ready);
  wanted_[angle] = halt();
  kept_.fill({});
}

void Driver::publish(Time now) {
  const auto count = static_cast<Eigen::Index>(motors);
  Reading reading{now, Eigen::VectorXd(count), Eigen::VectorXd(count), Eigen::VectorXd(count),
                  *std::max_element(temperature_->begin(), temperature_->end())};
  const Eigen::VectorXd most = model::max_effort(hand_);
  for (std::size_t i = 0; i < motors; ++i) {
    const auto d = static_cast<Eigen::Index>(i);
    const model::HandDof& dof = hand_.dofs()[i];
    reading.dof[d] = dof_of(dof, (*angle_)[i]);
    reading.velocity[d] = -velocity_[i] * (dof.upper - dof.lower) / open_count;
    // Where a finger says that it presses, with what it may; else what its gauge says.
    const double measured = force_ ? (*force_)[i] : 0;
    reading.effort[d] =
        most[d] * (presses(i) ? std::max<double>(measured, wanted_[force][i]) : measured) / full;
  }
  reading_ = std::move(reading);
}

std::optional<std::string> Driver::what_is_wrong() const {
  if (phase_ != Phase::ready || !angle_) return std::nullopt;
  for (std::size_t i = 0; i < motors; ++i)
    if (kept_[i].stuck() && std::abs(wanted_[angle][i] - (*angle_)[i]) > far)
      return std::string(dof_names[i]) + " is stuck";
  return std::nullopt;
}

}  // namespace prehend::robot::inspire
