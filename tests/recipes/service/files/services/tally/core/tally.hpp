#pragma once

#include <set>
#include <string>

namespace prehend::tally {

/// Counts grasps, each once, however often it is told of.
class Tally {
 public:
  /// False: it was counted before.
  bool add(const std::string& grasp, bool held);
  int grasps() const { return static_cast<int>(known_.size()); }
  int held() const { return held_; }

 private:
  std::set<std::string> known_;
  int held_ = 0;
};

}  // namespace prehend::tally
