#include "services/demonstration/core/tasks/learn_task.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace prehend::demonstration {

namespace {

/// The same step in all demonstrations.
using Same = std::vector<const tasks::ShownStep*>;

/// Mean place and mean rotation (the largest eigenvector of the sum of q qᵀ).
Pose mean_pose(const std::vector<Pose>& poses) {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  Eigen::Matrix4d turns = Eigen::Matrix4d::Zero();
  for (const Pose& X : poses) {
    place += X.translation() / static_cast<double>(poses.size());
    const Eigen::Vector4d q = Eigen::Quaterniond(X.linear()).coeffs();
    turns += q * q.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(turns);
  return make_pose(
      place, Eigen::Quaterniond(Eigen::Vector4d(solver.eigenvectors().col(3))).toRotationMatrix());
}

/// Root of the mean squared distance from the middle, m.
double spread_of(const std::vector<Pose>& poses) {
  const Eigen::Vector3d middle = mean_pose(poses).translation();
  double sum = 0;
  for (const Pose& X : poses) sum += (X.translation() - middle).squaredNorm();
  return std::sqrt(sum / static_cast<double>(poses.size()));
}

/// Where the object was put, relative to a reference; nothing if that was not always seen.
std::optional<std::vector<Pose>> places(const Same& same, const std::string& reference) {
  std::vector<Pose> made;
  for (const tasks::ShownStep* step : same) {
    if (reference == tasks::the_table) {
      made.push_back(step->X_WO_after);
      continue;
    }
    const auto found = step->X_WR.find(reference);
    if (found == step->X_WR.end()) return std::nullopt;
    made.push_back(found->second.inverse() * step->X_WO_after);
  }
  return made;
}

std::string nearest_reference(const tasks::ShownStep& step, double near) {
  std::string best = tasks::the_table;
  double least = near;
  for (const auto& [name, X_WR] : step.X_WR) {
    const double distance = (X_WR.translation() - step.X_WO_after.translation()).norm();
    if (distance <= least) least = distance, best = name;
  }
  return best;
}

std::string best_reference(const Same& same, const LearnOptions& options) {
  if (same.size() == 1) return nearest_reference(*same.front(), options.near);
  std::map<std::string, double> spreads{
      {tasks::the_table, spread_of(*places(same, tasks::the_table))}};
  for (const auto& [name, X_WR] : same.front()->X_WR)
    if (const auto found = places(same, name)) spreads[name] = spread_of(*found);
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [name, spread] : spreads) least = std::min(least, spread);
  // Of those that agree alike the nearest object is meant, and the table if none is near.
  std::string best;
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& [name, spread] : spreads) {
    if (spread > least + options.min_spread) continue;
    const double distance = name == tasks::the_table
                                ? options.near
                                : mean_pose(*places(same, name)).translation().norm();
    if (distance < nearest) nearest = distance, best = name;
  }
  return best;
}

/// Which step of a demonstration is the k-th with the object of step i of the first one.
Expected<std::vector<Same>> matched(const std::vector<tasks::ShownTask>& shown) {
  std::vector<Same> made;
  for (std::size_t i = 0; i < shown.front().size(); ++i) {
    const std::string& object = shown.front()[i].object;
    const auto is_object = [&](const tasks::ShownStep& step) { return step.object == object; };
    const auto before = std::count_if(
        shown.front().begin(), shown.front().begin() + static_cast<std::ptrdiff_t>(i), is_object);
    Same same;
    for (std::size_t d = 0; d < shown.size(); ++d) {
      if (shown[d].size() != shown.front().size())
        return fail(fmt::format("demonstrations have {} and {} steps", shown.front().size(),
                                shown[d].size()),
                    {}, "show the same task each time");
      std::ptrdiff_t seen = 0;
      for (const tasks::ShownStep& step : shown[d])
        if (is_object(step) && seen++ == before) same.push_back(&step);
      if (same.size() != d + 1)
        return fail(
            fmt::format("demonstration {} does not move {} as often as the first", d + 1, object),
            {}, "show the same task each time");
    }
    made.push_back(std::move(same));
  }
  return made;
}

tasks::Step learn_step(const Same& same, const LearnOptions& options) {
  tasks::Step made{.object = same.front()->object};
  made.reference = best_reference(same, options);
  const auto put = *places(same, made.reference);
  made.X_RO = mean_pose(put);
  made.spread = spread_of(put);
  made.upright = true;
  std::vector<Pose> grasps;
  std::vector<std::string> kinds;
  for (const tasks::ShownStep* step : same) {
    grasps.push_back(step->X_WO_before.inverse() * step->X_WG_grasped);
    kinds.push_back(step->grasp);
    made.upright &= step->max_tilt <= options.upright_tilt;
    const double ends =
        std::max(step->X_WO_before.translation().z(), step->X_WO_after.translation().z());
    made.via_height = std::max(made.via_height, step->highest - ends);
  }
  made.X_OG = mean_pose(grasps);
  made.grasp = *std::max_element(kinds.begin(), kinds.end(), [&](const auto& a, const auto& b) {
    return std::count(kinds.begin(), kinds.end(), a) < std::count(kinds.begin(), kinds.end(), b);
  });
  return made;
}

/// Whether step a came before step b in every demonstration.
bool always_before(const std::vector<tasks::ShownTask>& shown, const Same& a, const Same& b) {
  for (std::size_t d = 0; d < shown.size(); ++d)
    if (a[d] > b[d]) return false;  // both point into the same demonstration
  return true;
}

}  // namespace

Expected<tasks::TaskModel> learn_task(const std::string& name,
                                      const std::vector<tasks::ShownTask>& shown,
                                      const LearnOptions& options) {
  if (shown.empty() || shown.front().empty())
    return fail("nothing was shown", name, "take something and put it somewhere");
  const auto steps = matched(shown);
  if (!steps) return fail(steps.error().what, name, steps.error().hint);
  tasks::TaskModel made{name, shown.size(), {}};
  for (const Same& same : *steps) made.steps.push_back(learn_step(same, options));
  for (std::size_t i = 0; i < made.steps.size(); ++i)
    for (std::size_t k = 0; k < made.steps.size(); ++k) {
      if (i == k || !always_before(shown, (*steps)[k], (*steps)[i])) continue;
      const bool depends = made.steps[i].reference == made.steps[k].object ||
                           made.steps[k].reference == made.steps[i].object ||
                           made.steps[i].object == made.steps[k].object;
      if (depends) made.steps[i].after.push_back(k);
    }
  if (auto ok = check(made); !ok) return tl::unexpected(ok.error());
  return made;
}

}  // namespace prehend::demonstration
