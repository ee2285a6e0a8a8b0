#include "common/grasping/preshapes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "common/model/finger_chain.hpp"

namespace prehend::grasping {
namespace {

using Eigen::VectorXd;

// Shares of its range by which a DoF that does not close is turned aside.
constexpr std::array turned_aside{1.0 / 12, 1.0 / 2, 1.0 / 3};
constexpr double same_preshape = 0.05;  // rad, or what stands for it (radian_of), of each DoF

/// How much of their way the closing DoFs still have before them, on average.
double left_to_close(const model::HandModel& hand, const VectorXd& posture) {
  double left = 0;
  int count = 0;
  for (Eigen::Index i = 0; i < posture.size(); ++i) {
    const model::HandDof& dof = hand.dofs()[static_cast<std::size_t>(i)];
    if (dof.closing == 0) continue;
    const double way = dof.closing > 0 ? dof.upper - posture[i] : posture[i] - dof.lower;
    left += way / (dof.upper - dof.lower);
    ++count;
  }
  return count == 0 ? 0 : left / count;
}

/// What does not close, by this share of its range towards the limit that is farther away.
VectorXd aside(const model::HandModel& hand, VectorXd dof, double share) {
  for (Eigen::Index i = 0; i < dof.size(); ++i) {
    const model::HandDof& limits = hand.dofs()[static_cast<std::size_t>(i)];
    if (limits.closing != 0) continue;
    const double way = share * (limits.upper - limits.lower);
    dof[i] += limits.upper - dof[i] >= dof[i] - limits.lower ? way : -way;
  }
  return hand.clamp(dof);
}

bool alike(const model::HandModel& hand, const VectorXd& one, const VectorXd& other) {
  for (Eigen::Index i = 0; i < one.size(); ++i)
    if (std::abs(one[i] - other[i]) >
        same_preshape * model::radian_of(hand.dofs()[static_cast<std::size_t>(i)]))
      return false;
  return true;
}

/// Unless there is one like it.
void offer(const model::HandModel& hand, const VectorXd& dof, std::vector<VectorXd>& to) {
  if (std::none_of(to.begin(), to.end(),
                   [&](const VectorXd& other) { return alike(hand, dof, other); }))
    to.push_back(dof);
}

/// With all that closes as far open as it goes.
VectorXd opened_wide(const model::HandModel& hand, VectorXd dof) {
  for (Eigen::Index i = 0; i < dof.size(); ++i) {
    const model::HandDof& limits = hand.dofs()[static_cast<std::size_t>(i)];
    if (limits.closing != 0) dof[i] = limits.closing > 0 ? limits.lower : limits.upper;
  }
  return dof;
}

/// The DoFs that close each finger, from its base on.
std::vector<std::vector<int>> closing_of_fingers(const model::HandModel& hand) {
  std::vector<std::vector<int>> fingers;
  for (const model::HandFingertip& tip : hand.fingertips()) {
    std::vector<int>& dofs = fingers.emplace_back();
    for (const int joint : model::joints_to(hand, tip.link)) {
      const int dof = hand.joints()[static_cast<std::size_t>(joint)].dof;
      if (hand.dofs()[static_cast<std::size_t>(dof)].closing != 0 &&
          std::find(dofs.begin(), dofs.end(), dof) == dofs.end())
        dofs.push_back(dof);
    }
  }
  return fingers;
}

std::optional<std::size_t> finger_of(const model::HandModel& hand, model::Finger human) {
  const auto& tips = hand.fingertips();
  const auto found =
      std::find_if(tips.begin(), tips.end(), [&](const auto& tip) { return tip.human == human; });
  if (found == tips.end()) return std::nullopt;
  return static_cast<std::size_t>(found - tips.begin());
}

/// Fingers beside thumb and index finger, the farthest from the latter first. None where hand.toml
/// does not say which these are.
std::vector<std::size_t> farthest_fingers(const model::HandModel& hand) {
  const auto thumb = finger_of(hand, model::Finger::thumb);
  const auto index = finger_of(hand, model::Finger::index);
  if (!thumb || !index) return {};
  const auto tips = hand.fingertip_positions(hand.postures().at("open"));
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < tips.size(); ++i)
    if (i != *thumb && i != *index) others.push_back(i);
  std::stable_sort(others.begin(), others.end(), [&](std::size_t a, std::size_t b) {
    return (tips[a] - tips[*index]).norm() > (tips[b] - tips[*index]).norm();
  });
  return others;
}

/// The ways to close from a posture.
std::vector<Preshape> closings(const model::HandModel& hand, const VectorXd& posture) {
  constexpr double nearly_straight = 0.35;  // rad
  std::vector<Preshape> made{{posture, {}}};
  const auto fingers = closing_of_fingers(hand);
  const auto thumb = finger_of(hand, model::Finger::thumb);
  std::vector<bool> resting(hand.dofs().size(), false);
  auto straight = Preshape{posture, resting};
  for (std::size_t finger = 0; finger < fingers.size(); ++finger)
    for (std::size_t k = 1; k < fingers[finger].size() && finger != thumb; ++k) {
      const auto dof = static_cast<std::size_t>(fingers[finger][k]);
      const model::HandDof& limits = hand.dofs()[dof];
      const double open = limits.closing > 0 ? limits.lower : limits.upper;
      straight.resting[dof] = true;
      straight.dof[fingers[finger][k]] =
          open + limits.closing * nearly_straight * model::radian_of(limits);
    }
  straight.dof = hand.clamp(straight.dof);
  const auto others = farthest_fingers(hand);
  // Two fingers beside the thumb at least.
  for (std::size_t out = 0; out + 1 < others.size(); ++out) {
    for (const int dof : fingers[others[out]]) resting[static_cast<std::size_t>(dof)] = true;
    made.push_back({posture, resting});
  }
  if (std::find(straight.resting.begin(), straight.resting.end(), true) != straight.resting.end())
    made.push_back(std::move(straight));
  return made;
}

}  // namespace

std::vector<std::string> opened_postures(const model::HandModel& hand) {
  std::vector<std::string> names{"open"};
  for (const auto& [name, dof] : hand.postures())
    if (name != "open" && left_to_close(hand, dof) >= 0.5) names.push_back(name);
  return names;
}

std::vector<VectorXd> preshapes_of(const model::HandModel& hand) {
  std::vector<VectorXd> made;
  const VectorXd& open = hand.postures().at("open");
  offer(hand, open, made);
  for (const double share : turned_aside) offer(hand, aside(hand, open, share), made);
  for (const std::string& name : opened_postures(hand)) offer(hand, hand.postures().at(name), made);
  return made;
}

std::vector<Preshape> ways_to_close(const model::HandModel& hand) {
  std::vector<VectorXd> postures;
  const auto named = opened_postures(hand);
  for (std::size_t i = 1; i < named.size(); ++i)
    offer(hand, opened_wide(hand, hand.postures().at(named[i])), postures);
  const std::size_t wide = std::max<std::size_t>(postures.size(), 1);
  for (const VectorXd& dof : preshapes_of(hand)) offer(hand, dof, postures);
  std::vector<Preshape> likely, others;
  for (std::size_t i = 0; i < postures.size(); ++i)
    for (Preshape& way : closings(hand, postures[i]))
      (way.resting.empty() || i < wide ? likely : others).push_back(std::move(way));
  likely.insert(likely.end(), others.begin(), others.end());
  return likely;
}

}  // namespace prehend::grasping
