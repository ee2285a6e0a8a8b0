#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/pose.hpp"
#include "common/recording/types/value.hpp"

namespace prehend::console {

using recording::types::Value;

/// Looks into a message by the names of its fields. What is not there, or is something else, reads
/// as nothing: a message may come from a writer with another contract.
class View {
 public:
  View() = default;
  explicit View(const Value& value) : value_(&value) {}

  explicit operator bool() const { return value_ != nullptr; }
  View operator[](std::string_view field) const;
  /// Elements of a sequence or array, which bytes are not.
  std::vector<View> elements() const;

  double number() const;           // else not a number
  std::int64_t integer() const;    // else 0
  bool flag() const;               // else false
  std::string text() const;        // of strings and enumerators; else empty
  std::string_view bytes() const;  // of sequences of octets; else empty
  std::vector<double> numbers() const;
  Eigen::Vector3d vector() const;
  /// Refuses what is not finite or no rotation.
  Expected<Pose> pose() const;

 private:
  const Value* value_ = nullptr;
};

}  // namespace prehend::console
