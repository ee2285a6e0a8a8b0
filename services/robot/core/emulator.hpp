#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "common/model/hand_model.hpp"
#include "services/robot/core/driver.hpp"

namespace prehend::robot {

struct EmulatedOptions {
  bool initialized = false;   // knows where its joints are, as if homed before
  int temperature_bytes = 2;  // of its feedback, where the protocol leaves that open
  double velocity_scale = 1;  // how much faster it is than it is told, as units may be mistaken
  std::string wiring = {}, wiring_file = {};  // as of its driver
  int id = 0;                                 // on the line; 0: as it is sold
  int answers_as = 0;                         // the id in its answers; 0: its own
};

/// The far end of a robot's line as a value: what the host says in, what the robot says out.
/// Values of the DoFs are in their units.
class Emulator {
 public:
  virtual ~Emulator() = default;

  /// Answers to bytes that come at `now`.
  virtual std::string receive(std::string_view bytes, Duration now) = 0;
  /// Time passes: motors move, and what was waited for is said.
  virtual std::string pass(Duration now) = 0;

  /// Where the motors would be if nothing was in their way, but no further than they can press.
  virtual Eigen::VectorXd driven() const = 0;
  /// Where they are.
  virtual Eigen::VectorXd measured() const = 0;
  /// From now on something else says where they are, and what holds them: a twin.
  virtual void measure(const Eigen::VectorXd& dof) = 0;

  /// A joint moves no more, or again.
  virtual void block(std::size_t dof, bool blocked) = 0;
  virtual void heat(double celsius) = 0;
  /// It was switched off and on: what it does not keep without power is lost.
  virtual void restart() = 0;
};

struct EmulatorKind {
  std::string_view name;
  std::string_view hand, wiring;  // as of its driver
  Expected<std::unique_ptr<Emulator>> (*create)(const model::HandModel& hand,
                                                const EmulatedOptions& options);
  Medium medium;
  int baud;
};
const std::vector<EmulatorKind>& emulator_kinds();
Expected<const EmulatorKind*> find_emulator(std::string_view name);

}  // namespace prehend::robot
