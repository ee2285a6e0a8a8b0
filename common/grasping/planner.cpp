#include "common/grasping/planner.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "common/grasping/candidates.hpp"
#include "common/grasping/closing.hpp"

namespace prehend::grasping {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double margin = 0.004;      // m, between hand and object before the fingers close
constexpr double exact = 0.0005;      // m, in the search for that place
constexpr double far = 0.4;           // m, from where the hand comes
constexpr double lever = 0.3;         // m, longer than any finger: bounds how far a tip moves
constexpr double min_turn = 0.01;     // rad, of a step of closing without physics
constexpr double ranking_time = 2.5;  // s, for closing in the first round
constexpr double table_size = 2.0;    // m

/// A candidate that closed on the object.
struct Closed {
  int candidate = 0;
  Candidate sample;
  Pose X_OB;  // before closing
  double epsilon = -1;
};

/// The object at the origin of W and the hand about it, to measure distances in; nothing moves.
class Fitting {
 public:
  static Expected<Fitting> create(const model::HandModel& hand, const Body& object, bool table) {
    WorldOptions options;
    options.table = false;
    options.gravity_W.setZero();
    auto world =
        World::create(hand, make_pose(Vector3d(0, 0, 10)), hand.postures().at("open"), options);
    if (!world) return tl::unexpected(world.error());
    Body still = object;
    still.mass = 0;
    if (auto added = (*world)->add_body(still, Pose::Identity()); !added)
      return tl::unexpected(added.error());
    if (table) {
      const double height = model::half_extents(object.shape).z();
      const Body plate{"table", {model::ShapeKind::box, {table_size, table_size, 0.1}}, 0, "wood"};
      if (auto added = (*world)->add_body(plate, make_pose(Vector3d(0, 0, -height - 0.05))); !added)
        return tl::unexpected(added.error());
    }
    return Fitting(std::move(*world));
  }

  /// Comes along z of G until X_OG and `press_on` further, at most until the object is near.
  Expected<Pose> approach(const Candidate& candidate) {
    const Pose X_GB = world_->hand().X_BG().inverse();
    const Vector3d direction = candidate.X_OG.linear().col(2);
    Pose X_OG = candidate.X_OG;
    double left = far + candidate.press_on;
    X_OG.translation() -= far * direction;
    while (true) {
      world_->place_hand(X_OG * X_GB, candidate.preshape);
      const double room = world_->distance_to_hand(0, far) - margin;
      if (room < -exact) return fail("the open hand does not fit around the object");
      if (room < exact || left <= 0) break;
      const double step = std::min(room, left);
      X_OG.translation() += step * direction;
      left -= step;
    }
    return X_OG * X_GB;
  }

  /// Closes the fingers without physics until one is near the object.
  Expected<VectorXd> close(const Pose& X_OB, const VectorXd& preshape) {
    const auto& dofs = world_->hand().dofs();
    VectorXd dof = preshape;
    while (true) {
      world_->place_hand(X_OB, dof);
      const double room = world_->distance_to_hand(0, far) - margin;
      if (room < exact) return dof;
      VectorXd next = dof;
      for (Eigen::Index i = 0; i < dof.size(); ++i)
        next[i] += dofs[static_cast<std::size_t>(i)].closing * std::max(room / lever, min_turn) *
                   radian_of(dofs[static_cast<std::size_t>(i)]);
      next = world_->hand().clamp(next);
      if (next == dof) return fail("the fingers close beside the object");
      dof = next;
    }
  }

  bool in_table(const Pose& X_OB, const VectorXd& dof) {
    if (world_->body_count() < 2) return false;
    world_->place_hand(X_OB, dof);
    return world_->distance_to_hand(1, far) < 0;
  }

 private:
  explicit Fitting(std::unique_ptr<World> world) : world_(std::move(world)) {}
  std::unique_ptr<World> world_;
};

ClosingOptions closing_options(const Pose& X_OB) {
  ClosingOptions options;
  options.down_B = -X_OB.linear().transpose().col(2);
  return options;
}

/// Everything that is cheap first: most candidates end before any physics.
Expected<Closed> close_candidate(const model::HandModel& hand, const Body& object,
                                 const PlanOptions& options, int index) {
  Closed closed{index,
                sample_candidate(hand, object.shape, options.seed, index, options.off_posture),
                Pose::Identity()};
  auto fitting = Fitting::create(hand, object, options.table);
  if (!fitting) return tl::unexpected(fitting.error());
  const auto X_OB = fitting->approach(closed.sample);
  if (!X_OB) return tl::unexpected(X_OB.error());
  closed.X_OB = *X_OB;
  if (fitting->in_table(*X_OB, closed.sample.preshape)) return fail("the hand is in the table");
  const auto near = fitting->close(*X_OB, closed.sample.preshape);
  if (!near) return tl::unexpected(near.error());

  ClosingOptions coarse = closing_options(*X_OB);
  coarse.longest = ranking_time;
  coarse.volume = false;
  const auto grasp = close_hand(hand, object, X_OB->inverse(), *near, coarse);
  if (!grasp) return tl::unexpected(grasp.error());
  if (!grasp->quality.force_closure) return fail("no force closure");
  if (fitting->in_table(grasp->X_BO.inverse(), grasp->dof)) return fail("the hand is in the table");
  closed.epsilon = grasp->quality.epsilon;
  return closed;
}

/// Closes again, from the preshape itself, and lifts, shakes and turns.
Expected<PlannedGrasp> test(const model::HandModel& hand, const Body& object,
                            const Closed& closed) {
  ClosingOptions options = closing_options(closed.X_OB);
  options.hold_test = HoldOptions::long_form();
  auto grasp = close_hand(hand, object, closed.X_OB.inverse(), closed.sample.preshape, options);
  if (!grasp) return tl::unexpected(grasp.error());
  if (!grasp->quality.force_closure) return fail("no force closure");
  PlannedGrasp planned{closed.candidate,
                       closed.sample.posture,
                       closed.sample.preshape,
                       closed.X_OB,
                       grasp->X_BO.inverse(),
                       std::move(grasp->dof),
                       std::move(grasp->joints),
                       analysis::spread_contacts(grasp->contacts, analysis::max_contacts),
                       {},
                       std::move(grasp->quality),
                       std::move(*grasp->hold)};
  planned.wrenches = analysis::contact_wrenches(about_centre_of_mass(planned.contacts, object),
                                                torque_scale(object));
  return planned;
}

/// The most frequent of some reasons.
std::string mostly(const std::map<std::string, int>& reasons) {
  const auto most = std::max_element(reasons.begin(), reasons.end(),
                                     [](auto& a, auto& b) { return a.second < b.second; });
  return most == reasons.end() ? std::string() : most->first;
}

std::string millimetres(double length) {
  return std::to_string(std::lround(1000 * length)) + " mm";
}

std::string why_nothing_held(const model::HandModel& hand, const Plan& plan) {
  const double width = narrowest_width(plan.object.shape), opening = hand.reach().opening;
  if (width > opening)
    return "the object is wider than the hand's opening (" + millimetres(width) + ", " +
           millimetres(opening) + ")";
  if (plan.grasps.empty()) return "no candidate gave a grasp, mostly: " + mostly(plan.refused);
  std::map<std::string, int> reasons;
  for (const PlannedGrasp& grasp : plan.grasps) ++reasons[grasp.hold.reason];
  return "none of the " + std::to_string(plan.grasps.size()) +
         " best grasps held, mostly: " + mostly(reasons);
}

Expected<void> check(const Body& object, const PlanOptions& options) {
  if (!model::is_valid(object.shape)) return fail("shape is not valid", object.name);
  if (!(object.mass > 0) || !std::isfinite(object.mass))
    return fail("mass must be positive", object.name, "what is fixed cannot be lifted");
  if (options.candidates < 1 || options.candidates > 1'000'000)
    return fail("needs 1 to 1000000 candidates", "plan");
  if (options.tested < 1 || options.max_tested < options.tested)
    return fail("at least one grasp must be tested", "plan");
  return {};
}

}  // namespace

Expected<Plan> plan_grasps(const model::HandModel& hand, const Body& object,
                           const PlanOptions& options, const ForEach& for_each) {
  if (auto checked = check(object, options); !checked) return tl::unexpected(checked.error());
  // What makes every candidate fail is an error of its own.
  if (auto fitting = Fitting::create(hand, object, options.table); !fitting)
    return tl::unexpected(fitting.error());
  Plan plan{hand.name(), object, options};

  std::vector<Expected<Closed>> trials(static_cast<std::size_t>(options.candidates), Closed{});
  for_each(trials.size(), [&](std::size_t i) {
    trials[i] = close_candidate(hand, object, options, static_cast<int>(i));
  });
  std::vector<const Closed*> ranked;
  for (const auto& trial : trials) {
    if (trial)
      ranked.push_back(&*trial);
    else
      ++plan.refused[trial.error().what];
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const Closed* a, const Closed* b) { return a->epsilon > b->epsilon; });

  const auto most = std::min(ranked.size(), static_cast<std::size_t>(options.max_tested));
  for (std::size_t begin = 0; begin < most && !plan.held();) {
    const std::size_t count = std::min(most - begin, static_cast<std::size_t>(options.tested));
    std::vector<Expected<PlannedGrasp>> tested(count, PlannedGrasp{});
    for_each(count, [&](std::size_t i) { tested[i] = test(hand, object, *ranked[begin + i]); });
    for (auto& grasp : tested) {
      if (grasp)
        plan.grasps.push_back(std::move(*grasp));
      else
        ++plan.refused[grasp.error().what];
    }
    std::stable_sort(plan.grasps.begin(), plan.grasps.end(),
                     [](const PlannedGrasp& a, const PlannedGrasp& b) {
                       return std::pair(a.hold.held, a.quality.epsilon) >
                              std::pair(b.hold.held, b.quality.epsilon);
                     });
    begin += count;
  }
  plan.closed = static_cast<int>(ranked.size());
  if (!plan.held()) plan.reason = why_nothing_held(hand, plan);
  return plan;
}

}  // namespace prehend::grasping
