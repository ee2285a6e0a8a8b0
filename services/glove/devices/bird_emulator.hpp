#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "services/glove/devices/bird_protocol.hpp"
#include "services/glove/devices/emulator.hpp"

namespace prehend::glove::bird {

struct EmulatorOptions {
  std::vector<Site> sites = usual_sites();  // of the units, in the order of their addresses
  bool extended = false;                    // has an extended range transmitter
  /// Of the mirror in which the source's right hand is the left one that wears the sensors.
  Eigen::Vector3d left_to_right_T = Eigen::Vector3d::UnitX();
};

/// A tracker. Starts as one does when it is switched on: only the first unit runs, point mode, 36
/// inches, front hemisphere. Being busy after a reset or an auto-configure it does not listen, so
/// that a driver that does not wait is caught here. Range, hemisphere, format and button mode are
/// each unit's own, so that a driver that sets up only the first is caught as well.
class Emulator final : public glove::Emulator {
 public:
  explicit Emulator(const EmulatorOptions& options);

  std::string receive(std::string_view bytes, Duration now) override;
  std::vector<std::string> measure(const Frame& frame, Duration now) override;

  bool streaming() const { return streaming_ && !paused_; }

 private:
  struct Unit {
    Layout layout{.format = Format::position_angles};
    HemisphereInfo hemisphere = hemispheres[0];
  };

  std::string command(std::string_view bytes);
  std::string examine(std::uint8_t parameter);
  void change(std::uint8_t parameter, std::string_view value);
  std::vector<std::string> records() const;
  void reset();

  EmulatorOptions options_;
  Duration now_{}, busy_until_{};
  std::string pending_;  // of a command that is not complete
  std::vector<Unit> units_;
  int running_units_ = 1;
  int addressed_ = 1;
  bool group_ = false, streaming_ = false, paused_ = false;
  std::uint8_t error_ = 0;
  int report_every_ = 1;
  std::uint64_t measurements_ = 0;
  std::vector<Reading> readings_;
  std::vector<std::uint8_t> held_;  // buttons of the mouse at the first unit
};

}  // namespace prehend::glove::bird
