#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "common/model/hand_model.hpp"

namespace prehend::robot {

/// What a robot is ready for. Moving is a ready one that moves; stopped is the gate's word.
enum class Phase {
  offline,     // nobody answers
  configured,  // answers, and does not know where its joints are
  homing,      // finds that out; it moves
  homed,       // knows it, and does not yet listen to commands
  ready,       // follows commands
  faulted      // says that something is wrong with it
};
std::string_view to_string(Phase phase);

/// What it said of itself last. Values of the DoFs, in their units.
struct Reading {
  Time stamp{};
  Eigen::VectorXd dof, velocity;
  Eigen::VectorXd effort;             // N m or N, estimated; empty: it tells none
  std::optional<double> temperature;  // °C, the hottest
};

struct DriverOptions {
  int baud = 9600;              // of the line
  int id = 0;                   // of the device on it; 0: as it is sold
  double rate = 100;            // Hz, of commands, as far as the line has room
  double max_temperature = 60;  // °C, above which it is faulted
  Duration lost_after = std::chrono::milliseconds(300);  // without a sound answer
  std::string wiring = {}, wiring_file = {};  // which servo moves what, where hands differ in that
};

/// The near end of a robot's line as a value: bytes in, bytes out, and what they mean. All times
/// are given to it. What it is told to follow is within the hand's limits.
class Driver {
 public:
  virtual ~Driver() = default;

  /// The line is open: the conversation begins anew.
  virtual void connected(Time now) = 0;
  /// The line is gone.
  virtual void disconnected(const std::string& why) = 0;
  /// What has come, perhaps nothing; returns what is to be sent. Called often.
  virtual std::string step(std::string_view heard, Time now) = 0;
  /// What is to be sent before nobody calls step() any more: nothing moves after it.
  virtual std::string farewell() = 0;

  /// Finds out where its joints are, if it is configured or ready. The robot moves.
  virtual void home() = 0;
  /// Follows this posture from now on; effort: N m or N, that the drives may use; empty: all.
  virtual void follow(const Eigen::VectorXd& dof, const Eigen::VectorXd& effort, Time now) = 0;
  /// Stays where it is, at once, and ends its homing; what presses against something keeps
  /// pressing.
  virtual void hold() = 0;

  Phase phase() const { return phase_; }
  /// Of an offline or a faulted one: what is wrong.
  const std::string& trouble() const { return trouble_; }
  const std::optional<Reading>& reading() const { return reading_; }
  /// What kind of robot it says it is.
  const std::string& identity() const { return identity_; }
  /// Answers that were no sound ones since the last call, by what was wrong with them.
  std::vector<std::string> take_rejects() { return std::exchange(rejects_, {}); }

 protected:
  void be(Phase phase, std::string trouble = {}) {
    phase_ = phase;
    trouble_ = std::move(trouble);
  }
  /// Of a flood only so many are kept.
  void count_reject(std::string why) {
    if (rejects_.size() < 100) rejects_.push_back(std::move(why));
  }

  Phase phase_ = Phase::offline;
  std::string trouble_, identity_;
  std::optional<Reading> reading_;

 private:
  std::vector<std::string> rejects_;
};

/// How driver and robot are joined.
enum class Medium {
  serial,  // bytes over a port
  topics   // messages of ROS 2: each is one piece of what is heard or said
};

struct DriverKind {
  std::string_view name;
  std::string_view hand;    // model it drives; empty: any that has a wiring
  std::string_view wiring;  // file in the folder of such a hand; empty: none is needed
  Medium medium;
  int baud;  // of its line, unless somebody set it otherwise
  std::string_view description;
  Expected<std::unique_ptr<Driver>> (*create)(const model::HandModel& hand,
                                              const DriverOptions& options);
};
const std::vector<DriverKind>& driver_kinds();
Expected<const DriverKind*> find_driver(std::string_view name);

}  // namespace prehend::robot
