#include "services/mapping/core/palm_offset.hpp"

#include "services/mapping/core/size_input.hpp"

namespace prehend::mapping {

Expected<void> check(const PalmOffset& learnt) {
  constexpr double most = 0.1;  // m
  if (learnt.shape == model::ShapeKind::unknown) return fail("a place for no shape");
  if (!learnt.seen.allFinite()) return fail("a place for a size that is not finite");
  // Written so that not-a-number fails.
  if (!(learnt.p_GR.norm() <= most)) return fail("a place that is nowhere near the grasp");
  return {};
}

Eigen::Vector3d place_for(const std::vector<PalmOffset>& learnt, const model::Shape& shape,
                          const Pose& X_OG) {
  // Sizes count in m; grasping from above instead of from the side is like another 10 cm.
  const Eigen::Vector4d unit(1, 1, 1, 0.1);
  constexpr double alike = 0.005;  // m
  const Eigen::Vector4d seen = size_numbers(SizeInput::seen, shape, X_OG);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double weights = 0;
  for (const PalmOffset& place : learnt) {
    if (place.shape != shape.kind) continue;
    const double apart = (seen - place.seen).cwiseProduct(unit).squaredNorm() + alike * alike;
    const double weight = 1 / (apart * apart);
    sum += weight * place.p_GR;
    weights += weight;
  }
  return weights > 0 ? Eigen::Vector3d(sum / weights) : sum;
}

}  // namespace prehend::mapping
