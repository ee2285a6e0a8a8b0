#pragma once

#include <string>

#include "common/base/random.hpp"
#include "common/base/time.hpp"

namespace prehend::serial {

/// What goes wrong with bytes on a line. Shares are of records, 0 to 1.
struct LineFaults {
  double garbage = 0;     // before which foreign bytes come
  double drop_bytes = 0;  // that lose a byte
  double swap_bytes = 0;  // two of whose bytes change places
};

/// A record as it arrives.
std::string spoil(std::string record, const LineFaults& faults, Random& random);

/// Is `now` within `length` seconds after `begin`? Never, where that is negative.
bool within(Duration now, double begin, double length);

}  // namespace prehend::serial
