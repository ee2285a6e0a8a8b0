#include "common/tasks/task_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace prehend::tasks {

namespace {

constexpr std::size_t max_name = 64, max_steps = 1000;
constexpr double max_height = 2;  // m

Expected<void> check_step(const Step& step, std::size_t count) {
  if (step.object.empty() || step.object.size() > max_name)
    return fail("needs the name of an object, 1 to 64 bytes");
  if (step.reference.empty() || step.reference.size() > max_name)
    return fail("needs a reference, an object or the table");
  if (step.reference == step.object) return fail("puts an object relative to itself");
  if (step.grasp.size() > max_name) return fail("the name of its grasp is too long");
  if (!is_finite(step.X_OG) || !is_finite(step.X_RO)) return fail("a pose is not finite");
  if (!(step.spread >= 0) || !std::isfinite(step.spread))
    return fail("its spread is not a length of 0 or more");
  if (!(step.via_height >= 0 && step.via_height <= max_height))
    return fail("its via height is not between 0 and 2 m");
  for (const std::size_t before : step.after)
    if (before >= count)
      return fail(fmt::format("comes after step {}, which is not there", before + 1));
  return {};
}

}  // namespace

double tilt(const Pose& X_WO) {
  return std::acos(std::clamp(X_WO.linear()(2, 2), -1.0, 1.0));
}

Expected<std::vector<std::size_t>> order_of(const TaskModel& task) {
  std::vector<bool> done(task.steps.size(), false);
  std::vector<std::size_t> order;
  while (order.size() < task.steps.size()) {
    const std::size_t before = order.size();
    for (std::size_t i = 0; i < task.steps.size() && order.size() == before; ++i) {
      const auto& after = task.steps[i].after;
      if (done[i] ||
          !std::all_of(after.begin(), after.end(), [&](std::size_t k) { return done[k]; }))
        continue;
      done[i] = true;
      order.push_back(i);
    }
    if (order.size() == before)
      return fail("steps wait for each other in a circle", task.name, "mend what comes after what");
  }
  return order;
}

Expected<void> check(const TaskModel& task) {
  if (task.name.empty() || task.name.size() > max_name)
    return fail("a task needs a name of 1 to 64 bytes");
  if (task.steps.empty() || task.steps.size() > max_steps)
    return fail("a task needs 1 to 1000 steps", task.name);
  for (std::size_t i = 0; i < task.steps.size(); ++i)
    if (auto ok = check_step(task.steps[i], task.steps.size()); !ok)
      return fail(ok.error().what, fmt::format("{}, step {}", task.name, i + 1));
  if (auto order = order_of(task); !order) return tl::unexpected(order.error());
  return {};
}

std::optional<Error> lacking(const TaskModel& task,
                             const std::function<bool(const std::string&)>& is_there) {
  for (const Step& step : task.steps)
    for (const std::string& name : {step.object, step.reference})
      if (name != the_table && !is_there(name))
        return Error{"is not in this lab, and the task " + task.name + " needs it", name,
                     "put it in the camera's sight, or into the scene (lab.scene)", exit_no};
  return std::nullopt;
}

}  // namespace prehend::tasks
