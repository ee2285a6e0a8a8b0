#pragma once

#include <cstdint>
#include <vector>

#include "common/base/time.hpp"
#include "common/dds/guard/packet.hpp"

namespace prehend::dds {

/// Decides which newcomers Fast DDS may hear of. It has room for a hundred handshakes at a time,
/// and an invented newcomer keeps its place until its lease ends. So the first few are admitted at
/// once. In a crowd a newcomer must announce itself a second time: real ones do so twice a second,
/// a flood of invented ones does not. Pure. Takes memory only in a crowd.
class Admission {
 public:
  bool admits(const GuidPrefix& newcomer, Time now);

  static constexpr double at_once = 32, rate = 0.5;  // newcomers, and so many more a second
  // Announcements of one participant are this far apart.
  static constexpr Duration min_apart = std::chrono::milliseconds(50),
                            max_apart = std::chrono::milliseconds(2500);

 private:
  struct Waiting {
    std::uint64_t who = 0;
    Time since{};
  };
  double free_ = at_once;
  Time last_{};
  std::vector<Waiting> waiting_;  // each at a place of its own, unless two have the same
};

}  // namespace prehend::dds
