#include "services/planner/tools/hand/fit.hpp"

#include <algorithm>
#include <set>

#include "common/base/random.hpp"
#include "common/grasping/candidates.hpp"

namespace prehend::planner {

Span fingertip_span(const model::HandModel& hand) {
  Random random(1);
  Span found{1e9, 0};
  for (int trial = 0; trial < 4000; ++trial) {
    Eigen::VectorXd dof(static_cast<Eigen::Index>(hand.dofs().size()));
    for (std::size_t i = 0; i < hand.dofs().size(); ++i)
      dof[static_cast<Eigen::Index>(i)] =
          random.uniform(hand.dofs()[i].lower, hand.dofs()[i].upper);
    auto tips = hand.fingertip_positions(dof);
    if (tips.size() == 1) tips.push_back(Eigen::Vector3d::Zero());
    double span = 0;
    for (std::size_t i = 0; i < tips.size(); ++i)
      for (std::size_t k = i + 1; k < tips.size(); ++k)
        span = std::max(span, (tips[i] - tips[k]).norm());
    found.least = std::min(found.least, span);
    found.greatest = std::max(found.greatest, span);
  }
  return found;
}

std::vector<grasping::Body> trial_bodies(const std::vector<grasping::Body>& bodies,
                                         double opening) {
  std::vector<grasping::Body> ordered = bodies;
  std::stable_sort(ordered.begin(), ordered.end(), [](const auto& a, const auto& b) {
    return grasping::narrowest_width(a.shape) < grasping::narrowest_width(b.shape);
  });
  // A second of a kind, and what does not fit, only where nothing better is left.
  std::set<model::ShapeKind> kinds;
  const auto rank = [&](const grasping::Body& body) {
    const bool fits = grasping::narrowest_width(body.shape) < opening;
    return fits ? (kinds.insert(body.shape.kind).second ? 0 : 1) : 2;
  };
  std::vector<std::pair<int, grasping::Body>> ranked;
  for (const grasping::Body& body : ordered) ranked.emplace_back(rank(body), body);
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<grasping::Body> chosen;
  for (const auto& [order, body] : ranked)
    if (chosen.size() < 3) chosen.push_back(body);
  return chosen;
}

}  // namespace prehend::planner
