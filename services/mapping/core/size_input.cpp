#include "services/mapping/core/size_input.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/base/named_values.hpp"

namespace prehend::mapping {

namespace {

constexpr auto size_input_names =
    named_values<SizeInput>({{SizeInput::characteristic, "characteristic"},
                             {SizeInput::dimensions, "dimensions"},
                             {SizeInput::seen, "seen"}});

/// How far the shape reaches along a unit direction of its frame, from end to end, m.
double width(const model::Shape& shape, const Eigen::Vector3d& direction) {
  return model::extent(shape, direction) + model::extent(shape, -direction);
}

}  // namespace

std::string_view to_string(SizeInput input) {
  return size_input_names.name(input);
}

std::optional<SizeInput> size_input_from_string(std::string_view name) {
  return size_input_names.value(name);
}

int size_count(SizeInput input, model::ShapeKind shape) {
  if (input == SizeInput::seen) return 4;
  if (input == SizeInput::characteristic || shape == model::ShapeKind::sphere) return 1;
  return shape == model::ShapeKind::cylinder ? 2 : 3;
}

Eigen::VectorXd size_numbers(SizeInput input, const model::Shape& seen, const Pose& X_OG) {
  const bool cone = seen.kind == model::ShapeKind::cone;
  const model::Shape shape = cone ? model::like_known(seen) : seen;
  Eigen::VectorXd numbers(size_count(input, shape.kind));
  const Eigen::Matrix3d R = X_OG.linear();
  if (input == SizeInput::seen)
    numbers << width(shape, R.col(1)), width(shape, R.col(2)), width(shape, R.col(0)),
        std::clamp(-R(2, 2), 0.0, 1.0);
  else if (numbers.size() == 1)
    numbers << characteristic_size(shape);
  else if (numbers.size() == 2)
    numbers << shape.size.x(), shape.size.z();
  else
    numbers = shape.size;
  return numbers;
}

}  // namespace prehend::mapping
