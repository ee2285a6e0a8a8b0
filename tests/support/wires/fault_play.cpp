#include "tests/support/wires/fault_play.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <utility>

#include "common/ros2/joints.hpp"
#include "services/robot/devices/faulty_robot.hpp"
#include "services/robot/devices/line.hpp"
#include "tests/support/hands.hpp"

namespace prehend::test {
namespace {

using std::chrono::milliseconds;

constexpr Duration period = milliseconds(10);  // of commands
constexpr int strange_id = 3;                  // of a device that answers for another
constexpr Duration held_up = milliseconds(500);
constexpr double begins = 4;         // s: when the fault comes
constexpr double recovers_for = 8;   // s, after its end
constexpr double led_again_for = 4;  // s

// --- the faults

bool any(const WiredHand&) {
  return true;
}
bool of_a_line(const WiredHand& wired) {
  return wired.medium() == robot::Medium::serial;
}
bool of_one_device(const WiredHand& wired) {
  return wired.driver == "robotiq_2f85" || wired.driver == "inspire_rh56";
}
bool of_topics(const WiredHand& wired) {
  return wired.medium() == robot::Medium::topics;
}

bool is(const PlayedFault& fault, std::string_view name) {
  return fault.name.substr(0, fault.name.find(' ')) == name;
}

/// Sets what is to be wrong from `now` on, s.
void begin(const PlayedFault& fault, robot::FaultOptions& faults, double now) {
  const double share = fault.name.ends_with("10 %") ? 0.1 : 1;
  if (is(fault, "garbage")) faults.line.garbage = share;
  if (is(fault, "drop-bytes")) faults.line.drop_bytes = share;
  if (is(fault, "swap-bytes")) faults.line.swap_bytes = share;
  if (is(fault, "late")) faults.late = share;
  faults.silent_for = faults.cut_for = faults.hot_for = faults.stuck_for = fault_lasts;
  if (is(fault, "silence")) faults.silent_at = now;
  if (is(fault, "cut")) faults.cut_at = now;
  if (is(fault, "hot")) faults.hot_at = now;
  if (is(fault, "stuck")) faults.stuck_at = now;
  if (is(fault, "restart")) faults.restart_at = now;
}

/// Joint states as of other joints, or with one where it cannot be.
std::string misstated(const PlayedFault& fault, std::string message) {
  auto state = ros2::parse_joint_state(
      {reinterpret_cast<const std::uint8_t*>(message.data()), message.size()});
  if (!state) return message;
  if (fault.name == "other joints") state->names.front() += "_x";
  if (fault.name == "out of range")
    for (double& position : state->positions) position += 20;
  const ros2::Bytes bytes = ros2::joint_state(*state);
  return {bytes.begin(), bytes.end()};
}

// --- the line

/// What both ends have said, in computed time.
struct ComputedLine {
  bool cut = false;
  std::deque<std::string> to_robot, to_driver;
};

class ComputedChannel final : public robot::Channel {
 public:
  explicit ComputedChannel(ComputedLine& line) : line_(line) {}
  Expected<std::string> read() override {
    if (line_.cut) return fail("the port has disappeared");
    if (line_.to_driver.empty()) return std::string();
    std::string next = std::move(line_.to_driver.front());
    line_.to_driver.pop_front();
    return next;
  }
  Expected<void> write(std::string_view said) override {
    line_.to_robot.emplace_back(said);
    return {};
  }

 private:
  ComputedLine& line_;
};

// --- the play

constexpr const char* at_first = "does not answer";  // what a driver says before it has heard

class Stage {
 public:
  Stage(const WiredHand& wired, const PlayedFault& fault, std::uint64_t seed)
      : wired_(wired),
        fault_(fault),
        hand_(hand(wired.hand)),
        driver_(wired.near({.baud = std::max(wired.baud(), 1)})),
        line_(*driver_, opener()),
        open_(hand_.postures().at("open")) {
    faults_.seed = seed;
    plug_in(is(fault, "answers-as") ? strange_id : 0);
  }

  FaultPlay run();

 private:
  robot::Opener opener() {
    return [this]() -> Expected<std::unique_ptr<robot::Channel>> {
      if (computed_.cut) return fail("there is no such port");
      return std::make_unique<ComputedChannel>(computed_);
    };
  }
  void plug_in(int answers_as) {
    robot_ = wired_.far({.initialized = true, .answers_as = answers_as});
    faulty_.emplace(*robot_, faults_, wired_.baud());
  }
  void pass();
  void drive();
  void carry();
  void lead();
  void note();
  double moved_last() const;
  void end_fault();
  bool is_on() const { return t_ >= begin_ && t_ < begin_ + fault_lasts; }
  Time now() const { return from_ns(1'000'000'000) + time_; }
  Eigen::VectorXd posture(double share) const;

  const WiredHand& wired_;
  const PlayedFault& fault_;
  const model::HandModel& hand_;
  robot::FaultOptions faults_;
  std::unique_ptr<robot::Driver> driver_;
  std::unique_ptr<robot::Emulator> robot_;
  std::optional<robot::FaultyRobot> faulty_;
  ComputedLine computed_;
  robot::Line line_;
  Eigen::VectorXd open_;
  Duration time_{}, led_{};
  double t_ = 0, begin_ = begins;  // s
  bool stopped_ = false, was_ready_ = false, released_ = false;
  FaultPlay played_;
  std::vector<std::pair<double, Eigen::VectorXd>> way_;  // s; until it is ready or homed again
  std::optional<double> ready_since_;                    // s, after it was named
};

/// A share of the way from the open hand to the farther ends of the ranges.
Eigen::VectorXd Stage::posture(double share) const {
  Eigen::VectorXd dof = open_;
  for (Eigen::Index d = 0; d < dof.size(); ++d) {
    const model::HandDof& range = hand_.dofs()[static_cast<std::size_t>(d)];
    const bool up = range.upper - dof[d] > dof[d] - range.lower;
    dof[d] += share * ((up ? range.upper : range.lower) - dof[d]);
  }
  return dof;
}

/// It goes slowly, so that it moves as long as a fault lasts; against a stuck joint as fast as the
/// hand may.
void Stage::lead() {
  const double since = t_ - begin_;
  double share = std::clamp(0.3 + 0.1 * since, 0.1, 0.9);
  if (is(fault_, "stuck") && since > 0) share = std::min(0.3 + since, 0.9);
  if (released_) share = 0.5;
  driver_->follow(posture(share), {}, now());
}

/// As prehend-robot does: what becomes unready is stopped.
void Stage::drive() {
  line_.exchange(now());
  const bool ready = driver_->phase() == robot::Phase::ready;
  const bool told = is(fault_, "answers-as")
                        ? !driver_->trouble().empty() && driver_->trouble() != at_first
                        : was_ready_ && !ready;
  if (told && t_ >= begin_ && !played_.named) {
    played_.named = t_ - begin_;
    played_.words = driver_->trouble();
  }
  if (was_ready_ && !ready) {
    stopped_ = true;
    driver_->hold();
  }
  if (!ready) ready_since_.reset();
  if (ready && !ready_since_) ready_since_ = t_;
  was_ready_ = ready;
  for (const std::string& reject : driver_->take_rejects())
    if (is_on() && played_.rejects++ == 0) played_.reject = reject;
  if (ready && !stopped_ && time_ - led_ >= period) {
    led_ = time_;
    lead();
  }
}

void Stage::carry() {
  computed_.cut = of_a_line(wired_) && faulty_->is_cut(time_);
  if (computed_.cut) computed_ = {.cut = true, .to_robot = {}, .to_driver = {}};
  for (std::string& said : computed_.to_robot) faulty_->hear(std::move(said), time_);
  computed_.to_robot.clear();
  faulty_->step(time_);
  while (auto said = faulty_->take(time_))
    computed_.to_driver.push_back(of_topics(wired_) && is_on() ? misstated(fault_, *said) : *said);
}

/// When it was last elsewhere than where it then stays: by half a hundredth of a joint's range.
double Stage::moved_last() const {
  for (auto at = way_.rbegin(); at != way_.rend(); ++at)
    for (Eigen::Index d = 0; d < at->second.size(); ++d) {
      const model::HandDof& dof = hand_.dofs()[static_cast<std::size_t>(d)];
      if (std::abs(at->second[d] - way_.back().second[d]) > 0.005 * (dof.upper - dof.lower))
        return at->first;
    }
  return 0;
}

void Stage::note() {
  const Eigen::VectorXd where = robot_->measured();
  if (!released_ && !played_.homed && !(played_.named && was_ready_)) way_.emplace_back(t_, where);
  if (was_ready_ && driver_->reading() && now() - driver_->reading()->stamp < 2 * robot_tick)
    played_.astray =
        std::max(played_.astray, (driver_->reading()->dof - where).cwiseAbs().maxCoeff());
}

void Stage::pass() {
  drive();
  carry();
  note();
  time_ += robot_tick;
  t_ = to_seconds(time_);
}

void Stage::end_fault() {
  robot::FaultOptions& faults = faulty_->faults();
  faults = {.restart_at = faults.restart_at, .seed = faults.seed};
  if (is(fault_, "answers-as")) plug_in(0);
}

FaultPlay Stage::run() {
  const bool from_the_start = is(fault_, "answers-as");
  if (from_the_start) begin_ = 0;
  while (t_ < begin_) pass();
  const double begun = t_;
  begin(fault_, faulty_->faults(), begun);
  if (is(fault_, "held-up")) time_ += held_up;
  while (t_ < begun + fault_lasts) pass();
  const double end = t_;
  end_fault();
  // Somebody does what the driver says.
  if (played_.words.find("switch it off and on") != std::string::npos) robot_->restart();
  while (t_ < end + recovers_for) {
    // Somebody homes it, or robot.home does.
    if (driver_->phase() == robot::Phase::configured && was_ready_ == false) {
      driver_->home();
      played_.homed = true;
    }
    pass();
  }
  if (played_.named) played_.held = std::max(0.0, moved_last() - begun);
  if (ready_since_) played_.ready = std::max(0.0, *ready_since_ - end);
  released_ = true;
  stopped_ = false;
  for (const double begin_again = t_; t_ < begin_again + led_again_for;) pass();
  const Eigen::VectorXd off = (robot_->measured() - posture(0.5)).cwiseAbs();
  played_.follows = true;
  for (Eigen::Index d = 0; d < off.size(); ++d) {
    const model::HandDof& dof = hand_.dofs()[static_cast<std::size_t>(d)];
    played_.follows &= off[d] < 0.02 * (dof.upper - dof.lower);
  }
  return played_;
}

}  // namespace

const std::vector<PlayedFault>& played_faults() {
  static const std::vector<PlayedFault> faults{{"garbage 10 %", any},
                                               {"garbage", any},
                                               {"drop-bytes 10 %", any},
                                               {"drop-bytes", any},
                                               {"swap-bytes 10 %", any},
                                               {"swap-bytes", any},
                                               {"late 10 %", any},
                                               {"late", any},
                                               {"silence", any},
                                               {"cut", of_a_line},
                                               {"hot", of_a_line},
                                               {"stuck", any},
                                               {"restart", any},
                                               {"held-up", any},
                                               {"answers-as", of_one_device},
                                               {"other joints", of_topics},
                                               {"out of range", of_topics}};
  return faults;
}

FaultPlay play(const WiredHand& wired, const PlayedFault& fault, std::uint64_t seed) {
  return Stage(wired, fault, seed).run();
}

}  // namespace prehend::test
