#include "common/proto/pose_numbers.hpp"

#include <Eigen/LU>

namespace prehend::proto {

std::array<double, 12> pose_numbers(const Pose& X) {
  std::array<double, 12> numbers;
  for (int i = 0; i < 12; ++i) numbers[static_cast<std::size_t>(i)] = X.matrix()(i / 4, i % 4);
  return numbers;
}

Expected<Pose> pose_from_numbers(const std::vector<double>& numbers) {
  if (numbers.size() != 12) return fail("a pose is not twelve numbers");
  Pose X = Pose::Identity();
  for (int i = 0; i < 12; ++i) X.matrix()(i / 4, i % 4) = numbers[static_cast<std::size_t>(i)];
  if (!is_finite(X)) return fail("a pose is not finite");
  const Eigen::Matrix3d R = X.linear();
  constexpr double rounding = 1e-6;
  if (!(R * R.transpose()).isIdentity(rounding) || R.determinant() < 0)
    return fail("a pose's rotation is none");
  return X;
}

}  // namespace prehend::proto
