#include "services/demonstration/files/task_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <numbers>

#include "common/base/printable.hpp"
#include "common/proto/pose_numbers.hpp"
#include "common/proto/sealed_file.hpp"
#include "common/proto/task_model.pb.h"

namespace prehend::demonstration {

namespace {

constexpr std::string_view task_kind = "task";

template <class Numbers>
Expected<Pose> pose_of(const Numbers& numbers) {
  return proto::pose_from_numbers({numbers.begin(), numbers.end()});
}

Expected<Step> read(const messages::TaskStep& from) {
  auto X_OG = pose_of(from.grasp_frame());
  if (!X_OG) return tl::unexpected(X_OG.error());
  auto X_RO = pose_of(from.place());
  if (!X_RO) return tl::unexpected(X_RO.error());
  return Step{from.object(),     from.grasp(),   *X_OG,
              from.reference(),  *X_RO,          from.spread(),
              from.via_height(), from.upright(), {from.after().begin(), from.after().end()}};
}

std::string quoted(const std::string& text) {
  std::string made = "\"";
  for (const char c : printable(text)) {
    if (c == '"' || c == '\\') made += '\\';
    made += c;
  }
  return made + "\"";
}

std::string toml_pose(const Pose& X) {
  const Eigen::Vector3d p = X.translation();
  const Eigen::AngleAxisd turn(X.linear());
  const Eigen::Vector3d degrees = turn.axis() * turn.angle() * 180 / std::numbers::pi;
  return fmt::format(
      "{{ position_m = [{:.4f}, {:.4f}, {:.4f}], turn_deg = [{:.2f}, {:.2f}, {:.2f}] }}", p.x(),
      p.y(), p.z(), degrees.x(), degrees.y(), degrees.z());
}

}  // namespace

Expected<void> save_task(const std::filesystem::path& file, const TaskModel& task) {
  if (auto ok = check(task); !ok) return ok;
  messages::TaskModel message;
  message.set_name(task.name);
  message.set_demonstrations(static_cast<unsigned>(task.demonstrations));
  for (const Step& step : task.steps) {
    messages::TaskStep& to = *message.add_steps();
    to.set_object(step.object);
    to.set_grasp(step.grasp);
    const auto X_OG = proto::pose_numbers(step.X_OG), X_RO = proto::pose_numbers(step.X_RO);
    to.mutable_grasp_frame()->Add(X_OG.begin(), X_OG.end());
    to.set_reference(step.reference);
    to.mutable_place()->Add(X_RO.begin(), X_RO.end());
    to.set_spread(step.spread);
    to.set_via_height(step.via_height);
    to.set_upright(step.upright);
    for (const std::size_t before : step.after) to.add_after(static_cast<unsigned>(before));
  }
  return proto::write_sealed(file, task_kind, message.SerializeAsString());
}

Expected<TaskModel> load_task(const std::filesystem::path& file) {
  const auto refuse = [&](const Error& error) {
    return fail(error.message(), file.string(), "show the task again");
  };
  const auto bytes = proto::read_sealed(file, task_kind);
  if (!bytes) return tl::unexpected(bytes.error());
  messages::TaskModel message;
  if (!message.ParseFromString(*bytes)) return refuse({"holds no task", {}, {}});
  TaskModel task{message.name(), message.demonstrations(), {}};
  for (const messages::TaskStep& from : message.steps()) {
    auto step = read(from);
    if (!step) return refuse(step.error());
    task.steps.push_back(std::move(*step));
  }
  if (auto ok = check(task); !ok) return refuse(ok.error());
  return task;
}

std::string to_toml(const TaskModel& task) {
  std::string text =
      fmt::format("name = {}\ndemonstrations = {}\n", quoted(task.name), task.demonstrations);
  for (const Step& step : task.steps) {
    std::vector<std::size_t> after;
    for (const std::size_t before : step.after) after.push_back(before + 1);
    text += fmt::format(
        "\n[[step]]\nobject = {}\ngrasp = {}\ngrasp_frame = {}\nrelative_to = {}\nplace = {}\n"
        "spread_m = {:.4f}\nvia_height_m = {:.3f}\nupright = {}\nafter = [{}]\n",
        quoted(step.object), quoted(step.grasp), toml_pose(step.X_OG), quoted(step.reference),
        toml_pose(step.X_RO), step.spread, step.via_height, step.upright, fmt::join(after, ", "));
  }
  return text;
}

}  // namespace prehend::demonstration
