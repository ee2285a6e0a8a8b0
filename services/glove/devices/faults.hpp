#pragma once

#include <string>

#include "common/base/random.hpp"
#include "common/base/time.hpp"
#include "services/glove/core/frame.hpp"

namespace prehend::glove {

/// What goes wrong with gloves and their lines. Shares are of frames or of records, 0 to 1.
struct FaultOptions {
  double noise = 0;        // m, standard deviation of positions; joints: an angle at 5 cm of lever
  double extreme = 0;      // share of frames with a sensor up to 50 cm away, a joint anywhere
  double garbage = 0;      // share of records before which foreign bytes come
  double drop_bytes = 0;   // share of records that lose a byte
  double swap_bytes = 0;   // share of records two of whose bytes change places
  double silent_at = -1;   // s after the start, from when on the device says and hears nothing
  double silent_for = 2;   // s, that this lasts
  double unplug_at = -1;   // s after the start, when the cable is pulled out and power is lost
  double unplug_for = 2;   // s, until it is plugged in again
  std::uint64_t seed = 1;  // the same makes the same faults
};

/// Makes them. The same seed makes the same faults.
class Faults {
 public:
  explicit Faults(const FaultOptions& options) : options_(options), random_(options.seed) {}

  Frame spoil(Frame frame);
  std::string spoil(std::string record);
  bool silent(Duration since_start) const;
  bool unplugged(Duration since_start) const;

 private:
  FaultOptions options_;
  Random random_;
};

}  // namespace prehend::glove
