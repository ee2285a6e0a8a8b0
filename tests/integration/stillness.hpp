#pragma once

#include <optional>
#include <string>

#include "idl/Robot.h"

namespace prehend::integration {

/// Whether a robot hand stands still, by what robot/state says of its fingers and of its base. A
/// hand of which nothing is heard may be anywhere.
class Stillness {
 public:
  void add(const v1::HandState& state);
  /// What it did in these seconds; nothing when it stood still.
  std::optional<std::string> complaint(double seconds) const;

 private:
  std::optional<v1::HandState> first_;
  int heard_ = 0;
  double bent_ = 0, moved_ = 0, turned_ = 0;  // at most, rad, m, rad
};

}  // namespace prehend::integration
