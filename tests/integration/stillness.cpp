#include "tests/integration/stillness.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace prehend::integration {
namespace {

constexpr double max_bent = 0.02;    // rad, of a finger
constexpr double max_moved = 0.01;   // m, of the base
constexpr double max_turned = 0.05;  // rad, of the base
constexpr double min_rate = 10;      // Hz; 100 are sent

double angle(const v1::Quaternion& a, const v1::Quaternion& b) {
  const double cosine = std::abs(a.w() * b.w() + a.x() * b.x() + a.y() * b.y() + a.z() * b.z());
  return 2 * std::acos(std::min(cosine, 1.0));
}

}  // namespace

void Stillness::add(const v1::HandState& state) {
  ++heard_;
  if (!first_) first_ = state;
  const auto& from = first_->X_WB();
  const auto& to = state.X_WB();
  for (std::size_t i = 0; i < std::min(first_->dof().size(), state.dof().size()); ++i)
    bent_ = std::max(bent_, std::abs(state.dof()[i] - first_->dof()[i]));
  moved_ = std::max(moved_, std::hypot(to.position().x() - from.position().x(),
                                       to.position().y() - from.position().y(),
                                       to.position().z() - from.position().z()));
  turned_ = std::max(turned_, angle(from.orientation(), to.orientation()));
}

std::optional<std::string> Stillness::complaint(double seconds) const {
  if (heard_ < std::max(2.0, min_rate * seconds))
    return fmt::format("robot/state came {} times in {} s", heard_, seconds);
  if (bent_ > max_bent) return fmt::format("a finger bent by {} rad", bent_);
  if (moved_ > max_moved) return fmt::format("the base moved by {} m", moved_);
  if (turned_ > max_turned) return fmt::format("the base turned by {} rad", turned_);
  return std::nullopt;
}

}  // namespace prehend::integration
