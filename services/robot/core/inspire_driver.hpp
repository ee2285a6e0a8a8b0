#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "services/robot/core/inspire_protocol.hpp"
#include "services/robot/core/kept.hpp"
#include "services/robot/core/polled_driver.hpp"

namespace prehend::robot::inspire {

Expected<std::unique_ptr<robot::Driver>> create(const model::HandModel& hand,
                                                const DriverOptions& options);

/// A hand of six motors that go to a place by themselves, with a speed and up to a force, and say
/// how they fare. Its encoders are absolute, so there is nothing to home. A finger that is near its
/// goal goes slowly: at full speed it passes its force limit threefold. What it holds it keeps
/// holding, also when the wire is lost.
class Driver final : public PolledDriver {
 public:
  Driver(const model::HandModel& hand, const DriverOptions& options);

  std::string farewell() override { return stay(); }
  void home() override;
  void follow(const Eigen::VectorXd& dof, const Eigen::VectorXd& effort, Time now) override;
  void hold() override;

 private:
  /// What is told, in the order in which it counts.
  enum Told : std::size_t { force, speed, angle, told_count };

  void begin(Time now) override;
  std::string question(Time now) override;
  void feed(std::string_view bytes) override { parser_.feed(bytes); }
  Heard hear(Time now) override;
  void forget() override { parser_.clear(); }
  std::string stay() override;
  std::optional<std::string> what_is_wrong() const override;

  std::string ask(const Block& block);
  std::string tell(std::size_t what, Time now);
  std::optional<std::string> next_told(Time now);
  bool take(const Frame& answer, Time now);
  bool take_values(const Values& values, Time now);
  bool is_plausible(const Values& angles, Time now) const;
  void observe(const Values& angles, Time now);
  void judge(Time now);
  void become_ready();
  void fault(const std::string& why);
  void publish(Time now);
  bool presses(std::size_t motor) const;
  Values halt() const;
  int pressing(std::size_t motor) const;
  int speed_to(std::size_t motor, int goal) const;

  std::uint8_t id_;
  Parser parser_{Side::answers};
  Frame question_;  // the last one
  std::array<Values, told_count> wanted_{}, told_{};
  std::array<Time, told_count> told_at_{};  // when it took them; 0: never
  std::size_t telling_ = 0;
  std::optional<Values> angle_, force_, error_, status_, temperature_;
  std::size_t next_block_ = 0;
  bool reads_angle_ = false, clears_ = false, is_hot_ = false;
  Time cleared_{};          // when it was told last to forget its errors
  bool commanded_ = false;  // ever: before, nothing is said that could move it
  std::array<double, motors> velocity_{};
  std::array<Kept, motors> kept_{};  // from going where it shall be, or pressing
  Time read_{}, angles_at_{};
};

}  // namespace prehend::robot::inspire
