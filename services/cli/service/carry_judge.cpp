#include "services/cli/service/carry_judge.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace prehend::cli {
namespace {

constexpr double off_table = 0.005;  // m
constexpr double stands_for = 0.5;   // s
constexpr double holds_for = 1;      // s
constexpr double lift = 0.10, near = 0.03, level = 10 * std::numbers::pi / 180, nearly_all = 0.95;
constexpr double never_dropped = 0.99;

}  // namespace

bool Carried::done(CarryTask task) const {
  if (task == CarryTask::hand_over) return lifted >= lift && held >= never_dropped && handed_over;
  return set_down && lifted >= lift && off <= near && both >= nearly_all && tilt <= level;
}

void CarryJudge::see(const Pose& X_WO, Time stamp) {
  if (!X_WO_first_) {
    X_WO_first_ = X_WO;
    last_ = stamp;
  }
  const double elapsed = std::max(0.0, to_seconds(stamp - last_));
  last_ = stamp;
  const Eigen::Vector3d way = X_WO.translation() - X_WO_first_->translation();
  carried_.lifted = std::max(carried_.lifted, way.z());
  carried_.off = (way - carry_W_).head<2>().norm();
  const bool left = touches_["left"], right = touches_["right"];
  if (way.z() > off_table) {
    const Eigen::Vector3d up = X_WO.linear() * X_WO_first_->linear().transpose().col(2);
    carried_.tilt = std::max(carried_.tilt, std::acos(std::clamp(up.z(), -1.0, 1.0)));
    in_air_ += elapsed;
    if (left && right) by_both_ += elapsed;
    if (left || right) by_one_ += elapsed;
    carried_.both = in_air_ > 0 ? by_both_ / in_air_ : 0;
    carried_.held = in_air_ > 0 ? by_one_ / in_air_ : 0;
    left_alone_ |= left && !right;
    by_right_ = left_alone_ && right && !left ? by_right_ + elapsed : 0;
    carried_.handed_over |= by_right_ > holds_for;
    left_since_ = stamp;
  } else if (left || right) {
    left_since_ = stamp;
  } else if (carried_.lifted > 4 * off_table) {
    const bool rests = to_seconds(stamp - left_since_) > stands_for;
    carried_.set_down = rests && way.z() > -off_table;
    carried_.fell = rests && !carried_.set_down;
  }
}

}  // namespace prehend::cli
