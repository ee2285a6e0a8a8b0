#include "services/mapping/core/retargeting/retargeter.hpp"

#include <utility>

#include "services/mapping/core/retargeting/inverse_kinematics.hpp"
#include "services/mapping/core/retargeting/vector_matching.hpp"

namespace prehend::mapping {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

double mean_length(const Matrix3Xd& vectors) {
  return vectors.colwise().norm().mean();
}

HumanTips open_human_hand() {
  const model::HumanHand hand(1);
  const auto tips = hand.fingertip_poses(model::HumanHand::open_posture());
  HumanTips p_GT;
  for (std::size_t f = 0; f < tips.size(); ++f)
    p_GT[f] = hand.X_HG().inverse() * tips[f].translation();
  return p_GT;
}

}  // namespace

Retargeter::Retargeter(FollowingTips tips, Method method)
    : tips_(std::move(tips)), method_(method) {
  const model::HandModel& hand = tips_.hand();
  const Vector3d p_GH = model::HumanHand(1).X_HG().inverse().translation();
  const Vector3d p_GB = hand.X_BG().inverse().translation();
  const Matrix3Xd human = tips_.targets(open_human_hand())->colwise() - p_GH;
  const Matrix3Xd robot = tips_.positions(hand.postures().at("open")).colwise() - p_GB;
  scale_ = mean_length(robot) / mean_length(human);
}

Expected<Retargeter> Retargeter::create(const model::HandModel& hand, Method method) {
  auto tips = FollowingTips::create(hand);
  if (!tips) return tl::unexpected(tips.error());
  return Retargeter(std::move(*tips), method);
}

Expected<VectorXd> Retargeter::answer(const HumanTips& p_GT, const Vector3d& p_GH,
                                      const VectorXd& before) const {
  const auto targets = tips_.targets(p_GT);
  if (!targets) return tl::unexpected(targets.error());
  if (method_ == Method::cartesian) return reach(tips_, *targets, before);
  return match_vectors(tips_, scale_ * (targets->colwise() - p_GH), before);
}

}  // namespace prehend::mapping
