#include "common/grasping/table_grasps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/grasping/mesh_body.hpp"
#include "common/grasping/preshapes.hpp"
#include "common/model/past_contact.hpp"

namespace prehend::grasping {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

constexpr double pressed_on = 0.1;  // rad, past where fingers shall stop
// Near enough to what is usual that the mapping may correct a person's hand to it.
constexpr double beside = 0.010, nearer = 0.012, higher = 0.012;  // m
constexpr double turned = 0.17;                                   // rad
constexpr double steady =
    0.010;  // m, that the object may move while it is grasped, and in the hand

/// What may be otherwise than it was said: how the hand stands in its grasp frame, and the object.
struct Deviation {
  Vector3d moved = Vector3d::Zero();   // m
  Vector3d turned = Vector3d::Zero();  // rad
  double larger = 1, heavier = 1;
};

/// The likeliest to matter first: who is no better anyway is not tried with all.
std::vector<Deviation> deviations() {
  constexpr double off = 0.003, askew = 0.0349;  // m, rad
  return {{.moved = {0, off, 0}, .turned = {0, 0, askew}},
          {.moved = {0, -off, 0}, .turned = {0, 0, -askew}},
          {.heavier = 1.5},
          {.larger = 0.8},
          {.larger = 1.2},
          {.moved = {off, 0, 0}, .turned = {0, askew, 0}},
          {.moved = {-off, 0, 0}, .turned = {0, -askew, 0}},
          {.moved = {0, 0, -off}, .turned = {askew, 0, 0}}};
}

Pose displaced(const Vector3d& by, const Vector3d& turn) {
  const double angle = turn.norm();
  const Eigen::Matrix3d R = angle > 0 ? AngleAxisd(angle, turn / angle).toRotationMatrix()
                                      : Eigen::Matrix3d::Identity().eval();
  return make_pose(by, R);
}

/// Where a hand may stand in the grasp frame of an approach, the likeliest first. From the side,
/// where x leads down, also higher: fingers that curl may need more room above the table.
std::vector<Pose> places_to_stand(bool from_above) {
  const auto at = [](double x, double y, double z, double about_x = 0, double about_y = 0) {
    return displaced({x, y, z}, {about_x, about_y, 0});
  };
  std::vector<Pose> places{at(0, 0, 0), at(0, 0, -nearer), at(0, 0, nearer)};
  if (!from_above)
    for (const double up : {higher, 2 * higher})
      places.insert(places.end(), {at(-up, 0, 0), at(-up, 0, -nearer)});
  places.insert(places.end(),
                {at(0, beside, 0), at(0, -beside, 0), at(0, 0, 0, turned), at(0, 0, 0, -turned),
                 at(0, 0, 0, 0, turned), at(0, 0, 0, 0, -turned), at(0, beside, nearer),
                 at(0, -beside, nearer), at(0, beside, -nearer), at(0, -beside, -nearer)});
  return places;
}

std::vector<TableApproach> attempts_from(const model::HandModel& hand, const Body& object,
                                         const Pose& X_OG, std::size_t most) {
  const std::vector<Pose> everywhere = places_to_stand(is_from_above(X_OG));
  const std::vector<Preshape> preshapes = ways_to_close(hand);
  std::vector<TableApproach> made;
  // Along diagonals: what is likely in both respects first.
  for (std::size_t rank = 0; rank < everywhere.size() + preshapes.size(); ++rank)
    for (std::size_t k = 0; k < preshapes.size() && k <= rank; ++k)
      if (rank - k < everywhere.size() && made.size() < most) {
        TableApproach approach{X_OG * everywhere[rank - k], preshapes[k].dof, preshapes[k].resting};
        if (clears_table(hand, object, approach)) made.push_back(std::move(approach));
      }
  return made;
}

/// With fingers that went on past what they touched, as the mapping's do until they are stopped.
TableGrasp pressed(const model::HandModel& hand, TableGrasp grasp, double further) {
  grasp.dof = model::past_contact(hand, grasp.open, grasp.dof, grasp.closing, further);
  return grasp;
}

bool holds(const model::HandModel& hand, const Body& object, const TableGrasp& grasp,
           const Deviation& deviation) {
  Body other = scaled(object, deviation.larger);
  other.mass *= deviation.heavier;
  const bool smaller = deviation.larger < 1;
  TableGrasp there = smaller ? pressed(hand, grasp, model::full_follow_through) : grasp;
  // The hand goes where the object was said to be; the other one stands on the same table.
  const double higher =
      model::half_extents(other.shape).z() - model::half_extents(object.shape).z();
  there.X_OG =
      make_pose({0, 0, -higher}) * grasp.X_OG * displaced(deviation.moved, deviation.turned);
  // Drops what it drops at once.
  return held_on_table(hand, other, there, {.lift = 0.05, .hold = 0.3, .max_slip = steady});
}

/// How a hand comes to stand in one try and another.
std::vector<Pose> small_errors() {
  constexpr double off = 0.0009, askew = 0.01;  // m, rad
  std::vector<Pose> made;
  for (const double x : {1, -1})
    for (const double y : {1, -1})
      made.push_back(displaced(off * Vector3d(x, y, x * y), askew * Vector3d(y, x * y, x)));
  return made;
}

/// With fingers that go on as far as they may.
bool holds_pressed(const model::HandModel& hand, const Body& object, const TableGrasp& grasp,
                   const Pose& error) {
  TableGrasp there = pressed(hand, grasp, model::full_follow_through);
  there.X_OG = grasp.X_OG * error;
  return held_on_table(hand, object, there, {.hold = 1, .shake = true});
}

/// What an attempt comes to; the error says why it is no grasp.
Expected<TableGrasp> try_out(const model::HandModel& hand, const Body& object,
                             const TableApproach& approach) {
  auto closed = close_on_table(hand, object, approach);
  if (!closed) return closed;
  if (!held_on_table(hand, object, *closed, {.hold = 1, .max_slip = steady, .shake = true}))
    return fail("does not hold");
  const TableGrasp harder = pressed(hand, *closed, pressed_on);
  if (!held_on_table(hand, object, harder, {.lift = 0.05, .hold = 0.3}))
    return fail("does not hold when fingers press on");
  return closed;
}

}  // namespace

bool TableGraspSearch::Approach::is_sure(const SearchOptions& options) const {
  return !best.empty() && best.front().room >= options.enough;
}

bool TableGraspSearch::Approach::is_searched(const SearchOptions& options) const {
  if (judged >= options.judged || is_sure(options)) return true;
  return unjudged.empty() && next >= untried.size();
}

bool TableGraspSearch::Approach::is_done(const SearchOptions& options) const {
  return is_searched(options) && (pressed || !is_sure(options));
}

Expected<TableGraspSearch> TableGraspSearch::create(const model::HandModel& hand,
                                                    const Body& object,
                                                    const SearchOptions& options) {
  if (options.attempts < 1 || options.attempts > 1000 || options.at_once < 1 || options.judged < 1)
    return fail("attempts must be 1 to 1000", object.name);
  if (!is_valid(object.shape) || !(object.mass > 0) || !std::isfinite(object.mass))
    return fail("an object needs a size and a mass", object.name);
  TableGraspSearch made(hand, object, options);
  for (const Pose& X_OG : approaches(object.shape, hand.reach()))
    made.approaches_.push_back(
        {X_OG,
         attempts_from(hand, object, X_OG, static_cast<std::size_t>(options.attempts)),
         0,
         {},
         {},
         0});
  return made;
}

/// Each a task of its own, so that all threads have something to do.
struct TableGraspSearch::Task {
  enum class Kind { attempt, judgement, press };
  Approach* approach;
  Kind kind;
  std::size_t number;  // of the attempt, the deviation or the small error
  Expected<TableGrasp> closed = TableGrasp{};
  char held = 0;
};

std::vector<TableGraspSearch::Task> TableGraspSearch::next_round() {
  std::vector<Task> round;
  for (Approach& approach : approaches_) {
    if (approach.is_done(options_)) continue;
    if (approach.is_searched(options_)) {
      for (std::size_t i = 0; i < small_errors().size(); ++i)
        round.push_back({&approach, Task::Kind::press, i});
    } else if (!approach.unjudged.empty()) {
      for (std::size_t i = 0; i < deviations().size(); ++i)
        round.push_back({&approach, Task::Kind::judgement, i});
    } else {
      for (int i = 0; i < options_.at_once && approach.next < approach.untried.size(); ++i)
        round.push_back({&approach, Task::Kind::attempt, approach.next++});
    }
  }
  return round;
}

void TableGraspSearch::work_on(Task& task) const {
  const Approach& of = *task.approach;
  switch (task.kind) {
    case Task::Kind::attempt:
      task.closed = try_out(hand_, object_, of.untried[task.number]);
      return;
    case Task::Kind::judgement:
      task.held = holds(hand_, object_, of.unjudged.front().grasp, deviations()[task.number]);
      return;
    case Task::Kind::press:
      task.held = holds_pressed(hand_, object_, of.best.front().grasp, small_errors()[task.number]);
  }
}

bool TableGraspSearch::try_next(const ForEach& for_each) {
  std::vector<Task> round = next_round();
  for_each(round.size(), [&](std::size_t i) { work_on(round[i]); });
  std::map<Approach*, std::vector<char>> held;
  for (Task& task : round) {
    Approach& to = *task.approach;
    if (task.kind != Task::Kind::attempt) {
      held[&to].push_back(task.held);
      continue;
    }
    ++attempts_;
    if (task.closed)
      to.unjudged.push_back({.X_OG = to.X_OG,
                             .grasp = std::move(*task.closed),
                             .tried = static_cast<int>(task.number)});
    else
      ++refused_[task.closed.error().what];
  }
  for (const auto& [approach, each] : held) {
    if (approach->is_searched(options_))
      press(*approach, each);
    else
      judge(*approach, each);
  }
  return std::any_of(approaches_.begin(), approaches_.end(),
                     [&](const Approach& approach) { return !approach.is_done(options_); });
}

void TableGraspSearch::press(Approach& approach, const std::vector<char>& held) {
  approach.pressed = true;
  const auto count = static_cast<std::size_t>(std::count(held.begin(), held.end(), 1));
  if (2 * count < held.size()) approach.best.front().follow_through = 0;
}

void TableGraspSearch::judge(Approach& approach, const std::vector<char>& held) {
  SureGrasp grasp = std::move(approach.unjudged.front());
  approach.unjudged.erase(approach.unjudged.begin());
  ++approach.judged;
  grasp.room = static_cast<double>(std::count(held.begin(), held.end(), 1)) /
               static_cast<double>(held.size());
  if (approach.best.empty() || grasp.room > approach.best.front().room)
    approach.best = {std::move(grasp)};
}

std::vector<SureGrasp> TableGraspSearch::found() const {
  std::vector<SureGrasp> all;
  for (const Approach& approach : approaches_) {
    const auto& known = approach.best.empty() ? approach.unjudged : approach.best;
    if (!known.empty()) all.push_back(known.front());
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const SureGrasp& a, const SureGrasp& b) { return a.room > b.room; });
  return all;
}

}  // namespace prehend::grasping
