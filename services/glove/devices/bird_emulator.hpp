#pragma once

#include <prehend/base/random.hpp>
#include <prehend/base/time.hpp>
#include <prehend/glove/frame.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "bird_protocol.hpp"

namespace prehend::glove::bird {

/// Faults that a real line shows. Shares are of records.
struct Faults {
  double garbage = 0;     // share of records before which foreign bytes come
  double drop_bytes = 0;  // share of records that lose a byte
  std::uint64_t seed = 1;
};

/// The tracker's side of the protocol as a value: bytes from the host in, bytes to the host out.
/// Starts as a tracker does when it is switched on: no unit runs but the first, point mode, 36
/// inches. Being busy after a reset or an auto-configure it does not listen, so that a driver that
/// does not wait is caught here.
class Emulator {
 public:
  explicit Emulator(int units, const Faults& faults = {});

  /// What it answers to bytes that come at `now` (any clock that does not run backwards).
  std::string receive(std::string_view bytes, Duration now);

  /// A new measurement; units take their sensors by site, see sites_by_address(). In stream mode
  /// its records are returned; in point mode they wait to be asked for.
  std::string measure(const Frame& frame, Duration now);

  bool streaming() const { return streaming_ && !paused_; }
  const Layout& layout() const { return layout_; }

 private:
  std::string command(std::string_view bytes);
  std::string examine(std::uint8_t parameter) const;
  void change(std::uint8_t parameter, std::string_view value);
  std::string records();
  void reset();

  int units_;
  Faults faults_;
  Random random_;
  Duration now_{}, busy_until_{};
  std::string pending_;  // of a command that is not complete
  Layout layout_;
  std::vector<Format> unit_format_;
  int running_units_ = 1;
  int addressed_ = 1;
  bool streaming_ = false, paused_ = false;
  int report_every_ = 1;
  std::uint64_t measurements_ = 0;
  std::vector<Reading> readings_;
};

}  // namespace prehend::glove::bird
