#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/pose.hpp"
#include "common/recording/types/value.hpp"

namespace prehend::recorder::dataset {

/// Where in a message something is: `pose.position`, `position[2]`, `tips[0].x`. Empty: all of it.
class FieldPath {
 public:
  static Expected<FieldPath> parse(std::string_view text);

  /// Nothing where the message has no such field.
  const recording::types::Value* in(const recording::types::Value& message) const;
  /// What holds it: without the last step.
  const recording::types::Value* holder_in(const recording::types::Value& message) const;
  const std::string& text() const { return text_; }

 private:
  const recording::types::Value* after(const recording::types::Value& message,
                                       std::size_t steps) const;

  std::string text_;
  std::vector<std::variant<std::string, std::size_t>> steps_;
};

/// All numbers of a value, one after the other, and what each is called: fields by their names,
/// elements of lists by their places. None where something is no finite number.
struct Flat {
  std::vector<double> numbers;
  std::vector<std::string> names;
};
std::optional<Flat> flat(const recording::types::Value& value);

/// position and orientation, as of geometry_msgs/Pose, or translation and rotation, as of its
/// Transform.
std::optional<Pose> as_pose(const recording::types::Value& value);
/// Does it look like one, whatever its numbers are?
bool has_parts_of_pose(const recording::types::Value& value);

/// Texts of a list; none where something is no text.
std::optional<std::vector<std::string>> texts(const recording::types::Value& value);

/// Bytes, or base64 in a text as JSON has them.
std::optional<std::vector<std::uint8_t>> bytes_of(const recording::types::Value& value);

/// Yes: true, a number that is not 0, a text that is not empty.
bool is_yes(const recording::types::Value& value);

}  // namespace prehend::recorder::dataset
