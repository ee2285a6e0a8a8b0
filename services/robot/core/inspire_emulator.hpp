#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/robot/core/emulator.hpp"
#include "services/robot/core/inspire_protocol.hpp"

namespace prehend::robot::inspire {

Expected<std::unique_ptr<robot::Emulator>> emulate(const model::HandModel& hand,
                                                   const EmulatedOptions& options);

/// A hand of six motors: each goes to its angle with its speed, presses up to its force, and says
/// how it fares. One that is kept from moving by itself stalls, which is an error until it is
/// cleared.
class Emulator final : public robot::Emulator {
 public:
  Emulator(const model::HandModel& hand, const EmulatedOptions& options);

  std::string receive(std::string_view bytes, Duration now) override;
  std::string pass(Duration now) override;
  Eigen::VectorXd driven() const override;
  Eigen::VectorXd measured() const override;
  void measure(const Eigen::VectorXd& dof) override;
  void block(std::size_t dof, bool blocked) override { units_.at(dof).blocked = blocked; }
  void heat(double celsius) override { celsius_ = celsius; }
  void restart() override;
  /// From now on it answers with this id.
  void answer_as(std::uint8_t id) { answers_as_ = id; }
  int force_limit(std::size_t motor) const { return units_.at(motor).force; }
  int speed(std::size_t motor) const { return units_.at(motor).speed; }

 private:
  struct Unit {
    double squeeze = 0;  // counts past a contact, by which it presses with all its force
    double position = open_count, driven = open_count, seen = open_count;
    int goal = open_count, force = full, speed = full;
    int status = arrived, error = 0;
    bool blocked = false;
    Duration still_since{};
  };

  void move(Unit& unit, double dt) const;
  void watch(Unit& unit) const;
  std::optional<std::string> answer(const Frame& question);
  bool write(const Frame& question);
  Values shown(const Block& block) const;

  const model::HandModel& hand_;
  EmulatedOptions options_;
  std::array<Unit, motors> units_;
  std::uint8_t id_, answers_as_;
  Parser parser_{Side::asks};
  bool twin_ = false;
  double celsius_ = 32;
  Duration now_{}, heard_{};
};

}  // namespace prehend::robot::inspire
