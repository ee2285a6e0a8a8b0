#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/robot/core/barrett_protocol.hpp"
#include "services/robot/core/emulator.hpp"

namespace prehend::robot::barrett {

/// A BarrettHand. Starts as one that was switched on: it does not know where its joints are, and
/// refuses to move until HI. In RealTime mode a motor keeps its velocity until it is told another,
/// as the real one does, so that a driver that falls silent is caught here.
class Emulator final : public robot::Emulator {
 public:
  Emulator(const model::HandModel& hand, const EmulatedOptions& options);

  std::string receive(std::string_view bytes, Duration now) override;
  std::string pass(Duration now) override;
  Eigen::VectorXd driven() const override;
  Eigen::VectorXd measured() const override;
  void measure(const Eigen::VectorXd& dof) override;
  void block(std::size_t dof, bool blocked) override;
  void heat(double celsius) override { temperature_ = celsius; }
  void restart() override;

 private:
  struct Motor {
    double position = 0, driven = 0;  // counts: of the encoder, of the motor
    double joint = 0;                 // counts, of a twin
    double velocity = 0;              // counts/s, commanded in RealTime mode
    std::optional<double> target;     // counts, of a movement command
    bool initialized = false, homing = false, blocked = false;
    std::map<std::string, int, std::less<>> parameters;
  };
  enum class Mode { supervisory, moving, realtime };

  void move(double dt);
  std::string line(const std::string& text);
  std::string execute(unsigned motors, const std::string& command,
                      const std::vector<std::string>& arguments);
  std::string begin(unsigned motors, const std::string& command,
                    const std::vector<std::string>& arguments);
  std::string set(unsigned motors, const std::vector<std::string>& arguments);
  std::string get(unsigned motors, const std::vector<std::string>& arguments) const;
  std::string global(const std::string& command, const std::vector<std::string>& arguments);
  std::string realtime(char byte);
  std::string block_done();
  std::string break_off();
  std::string ready(int error = 0) const;
  std::size_t control_size() const;
  int feedback_temperature() const;

  EmulatedOptions options_;
  std::array<Motor, motors> motors_;
  std::array<double, motors> squeeze_{};  // counts
  std::map<std::string, int, std::less<>> globals_;
  Mode mode_ = Mode::supervisory;
  bool twin_ = false;
  std::string line_;   // of a command that is not complete
  std::string block_;  // of RealTime mode
  double temperature_ = 32;
  Duration now_{};
};

}  // namespace prehend::robot::barrett
