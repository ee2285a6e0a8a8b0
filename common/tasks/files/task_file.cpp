#include "common/tasks/files/task_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>
#include <tuple>

#include "common/base/paths.hpp"
#include "common/base/printable.hpp"
#include "common/base/toml_document.hpp"
#include "common/model/toml_values.hpp"
#include "common/proto/pose_numbers.hpp"
#include "common/proto/sealed_file.hpp"
#include "common/proto/task_model.pb.h"

namespace prehend::tasks {

namespace {

constexpr std::string_view task_kind = "task";
constexpr std::size_t max_runs = 100;  // that are kept

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

template <class Numbers>
void put(Numbers& to, const Pose& X) {
  const auto numbers = proto::pose_numbers(X);
  to.Add(numbers.begin(), numbers.end());
}

Expected<ShownStep> read(const messages::ShownStep& from) {
  ShownStep made{.object = from.object(), .grasp = from.grasp()};
  const auto hand = pose_of(from.hand()), before = pose_of(from.before()),
             after = pose_of(from.after());
  for (const auto* pose : {&hand, &before, &after})
    if (!*pose) return tl::unexpected(pose->error());
  made.X_WG_grasped = *hand;
  made.X_WO_before = *before;
  made.X_WO_after = *after;
  made.highest = from.highest();
  made.max_tilt = from.max_tilt();
  if (!std::isfinite(made.highest) || !std::isfinite(made.max_tilt))
    return fail("a number is not finite");
  for (const auto& reference : from.references()) {
    const auto X_WR = pose_of(reference.pose());
    if (!X_WR) return tl::unexpected(X_WR.error());
    made.X_WR[reference.name()] = *X_WR;
  }
  return made;
}

void write(const ShownTask& shown, messages::ShownTask& to) {
  for (const ShownStep& step : shown) {
    messages::ShownStep& made = *to.add_steps();
    made.set_object(step.object);
    made.set_grasp(step.grasp);
    put(*made.mutable_hand(), step.X_WG_grasped);
    put(*made.mutable_before(), step.X_WO_before);
    put(*made.mutable_after(), step.X_WO_after);
    made.set_highest(step.highest);
    made.set_max_tilt(step.max_tilt);
    for (const auto& [name, X_WR] : step.X_WR) {
      messages::ShownReference& reference = *made.add_references();
      reference.set_name(name);
      put(*reference.mutable_pose(), X_WR);
    }
  }
}

void write(const Step& step, messages::TaskStep& to) {
  to.set_object(step.object);
  to.set_grasp(step.grasp);
  put(*to.mutable_grasp_frame(), step.X_OG);
  to.set_reference(step.reference);
  put(*to.mutable_place(), step.X_RO);
  to.set_spread(step.spread);
  to.set_via_height(step.via_height);
  to.set_upright(step.upright);
  for (const std::size_t before : step.after) to.add_after(static_cast<unsigned>(before));
}

Expected<TaskRecord> read(const messages::TaskModel& message) {
  TaskRecord made{.task = {message.name(), message.demonstrations(), {}}};
  for (const messages::TaskStep& from : message.steps()) {
    auto step = read(from);
    if (!step) return tl::unexpected(step.error());
    made.task.steps.push_back(std::move(*step));
  }
  if (auto ok = check(made.task); !ok) return tl::unexpected(ok.error());
  for (const messages::ShownTask& from : message.shown()) {
    ShownTask& shown = made.shown.emplace_back();
    for (const messages::ShownStep& each : from.steps()) {
      auto step = read(each);
      if (!step) return tl::unexpected(step.error());
      shown.push_back(std::move(*step));
    }
  }
  for (const messages::TaskRun& run : message.runs())
    made.runs.push_back({from_ns(run.stamp_ns()), run.hand(), run.done(), run.reason()});
  return made;
}

}  // namespace

Expected<void> save_record(const std::filesystem::path& file, const TaskRecord& record) {
  if (auto ok = check(record.task); !ok) return ok;
  messages::TaskModel message;
  message.set_name(record.task.name);
  message.set_demonstrations(static_cast<unsigned>(record.task.demonstrations));
  for (const Step& step : record.task.steps) write(step, *message.add_steps());
  for (const ShownTask& shown : record.shown) write(shown, *message.add_shown());
  const std::size_t first = record.runs.size() - std::min(record.runs.size(), max_runs);
  for (std::size_t i = first; i < record.runs.size(); ++i) {
    messages::TaskRun& run = *message.add_runs();
    run.set_stamp_ns(to_ns(record.runs[i].stamp));
    run.set_hand(record.runs[i].hand);
    run.set_done(record.runs[i].done);
    run.set_reason(record.runs[i].reason);
  }
  return proto::write_sealed(file, task_kind, message.SerializeAsString());
}

Expected<TaskRecord> load_record(const std::filesystem::path& file) {
  const auto refuse = [&](const Error& error) {
    return fail(error.message(), file.string(), "show the task again");
  };
  const auto bytes = proto::read_sealed(file, task_kind);
  if (!bytes) return tl::unexpected(bytes.error());
  messages::TaskModel message;
  if (!message.ParseFromString(*bytes)) return refuse({"holds no task", {}, {}});
  auto record = read(message);
  if (!record) return refuse(record.error());
  return record;
}

Expected<void> save_task(const std::filesystem::path& file, const TaskModel& task) {
  return save_record(file, {.task = task});
}

Expected<TaskModel> load_task(const std::filesystem::path& file) {
  return load_record(file).map([](const TaskRecord& record) { return record.task; });
}

std::filesystem::path task_folder(const std::string& named) {
  if (!named.empty()) return named;
  const auto state = state_directory();
  return state.empty() ? state : state / "tasks";
}

Expected<std::filesystem::path> task_path(const std::string& task,
                                          const std::filesystem::path& folder) {
  if (task.ends_with(".task")) return std::filesystem::path(task);
  const bool sound = !task.empty() && task.size() <= 64 && task.front() != '.' &&
                     task.front() != '-' &&
                     std::all_of(task.begin(), task.end(), [](unsigned char c) {
                       return std::isalnum(c) || c == '-' || c == '_' || c == ' ' || c == '.';
                     });
  if (!sound)
    return wrong_use("is no name of a task", printable(task),
                     "up to 64 letters, digits, spaces, dots, - and _");
  if (folder.empty())
    return fail("there is no folder for tasks", "demonstration.tasks", "name one");
  return folder / (task + ".task");
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

namespace {

constexpr double farthest = 10;  // m, of any place that a person showed
constexpr std::int64_t max_demonstrations = 1'000'000;

/// { position_m = [3], turn_deg = [3] }: axis times angle.
Expected<Pose> pose_in(const toml::table& table, std::string_view key, const std::string& where) {
  const toml::table* pose = table[key].as_table();
  const std::string here = where + ", " + std::string(key);
  if (!pose)
    return fail("is missing or no table", here,
                "as { position_m = [0, 0, 0], turn_deg = [0, 0, 0] }");
  if (auto ok = model::only_keys(*pose, {"position_m", "turn_deg"}, here, {}); !ok)
    return tl::unexpected(ok.error());
  const auto position = model::numbers(pose->get("position_m"), 3, here + ".position_m");
  if (!position) return tl::unexpected(position.error());
  if (position->cwiseAbs().maxCoeff() > farthest)
    return fail("is too far away to be meant", here + ".position_m", "metres");
  const auto degrees = model::numbers(pose->get("turn_deg"), 3, here + ".turn_deg");
  if (!degrees) return tl::unexpected(degrees.error());
  const Eigen::Vector3d turn = *degrees * std::numbers::pi / 180;
  const double angle = turn.norm();
  return make_pose(Eigen::Vector3d(*position),
                   angle > 0 ? Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix()
                             : Eigen::Matrix3d::Identity().eval());
}

/// The value of a key, or `otherwise` where the key is absent. One of another type, as "true" in
/// place of true, must not pass as absent.
template <class T>
Expected<T> value_or(const toml::table& table, std::string_view key, T otherwise,
                     std::string_view type, const std::string& where) {
  if (!table.contains(key)) return otherwise;
  if (auto value = table[key].template value_exact<T>()) return std::move(*value);
  return fail(fmt::format("{} is no {}", key, type), where, "see prehend tasks show");
}

/// Steps that come before, counted from 0.
Expected<std::vector<std::size_t>> after_in(const toml::table& table, const std::string& where) {
  std::vector<std::size_t> made;
  if (!table.contains("after")) return made;
  const toml::array* after = table["after"].as_array();
  if (!after) return fail("after is no list of steps", where, "as [1, 2]");
  for (const toml::node& node : *after) {
    const auto number = node.value<std::int64_t>();
    if (!number || *number < 1)
      return fail("comes after what is no step", where, "steps count from 1");
    made.push_back(static_cast<std::size_t>(*number - 1));
  }
  return made;
}

Expected<Step> step_in(const toml::table& table, const std::string& where) {
  if (auto ok = model::only_keys(table,
                                 {"object", "grasp", "grasp_frame", "relative_to", "place",
                                  "spread_m", "via_height_m", "upright", "after"},
                                 where, "see prehend tasks show");
      !ok)
    return tl::unexpected(ok.error());
  Step made;
  for (const auto& [key, otherwise, to] :
       {std::tuple("object", std::string(), &made.object),
        std::tuple("grasp", std::string(), &made.grasp),
        std::tuple("relative_to", std::string(the_table), &made.reference)}) {
    auto text = value_or(table, key, otherwise, "text", where);
    if (!text) return tl::unexpected(text.error());
    *to = std::move(*text);
  }
  const auto upright = value_or(table, "upright", false, "true or false", where);
  if (!upright) return tl::unexpected(upright.error());
  made.upright = *upright;
  const auto X_OG = pose_in(table, "grasp_frame", where), X_RO = pose_in(table, "place", where);
  if (!X_OG) return tl::unexpected(X_OG.error());
  if (!X_RO) return tl::unexpected(X_RO.error());
  const auto spread = model::number_or(table, "spread_m", 0, where),
             via = model::number_or(table, "via_height_m", 0, where);
  if (!spread) return tl::unexpected(spread.error());
  if (!via) return tl::unexpected(via.error());
  if (!(*spread >= 0 && *spread <= farthest && *via >= 0 && *via <= farthest))
    return fail("spread_m and via_height_m are 0 to 10", where, "metres");
  made.X_OG = *X_OG;
  made.X_RO = *X_RO;
  made.spread = *spread;
  made.via_height = *via;
  auto after = after_in(table, where);
  if (!after) return tl::unexpected(after.error());
  made.after = std::move(*after);
  return made;
}

}  // namespace

Expected<TaskModel> from_toml(std::string_view text, const std::string& file) {
  const auto root = parse_toml(text, file);
  if (!root) return tl::unexpected(root.error());
  if (auto ok = model::only_keys(*root, {"name", "demonstrations", "step"}, file,
                                 "see prehend tasks show");
      !ok)
    return tl::unexpected(ok.error());
  const auto name = value_or(*root, "name", std::string(), "text", file);
  if (!name) return tl::unexpected(name.error());
  const auto count = value_or(*root, "demonstrations", std::int64_t{0}, "number", file);
  if (!count) return tl::unexpected(count.error());
  if (*count < 0 || *count > max_demonstrations)
    return fail(fmt::format("demonstrations must be 0 to {}", max_demonstrations), file);
  // Its file bears the name.
  if (auto path = task_path(*name, "."); !path || name->find('/') != std::string::npos)
    return fail(fmt::format("the name «{}» is no name of a file", printable(*name)), file,
                "letters, digits and blanks");
  TaskModel made{*name, static_cast<std::size_t>(*count), {}};
  const auto steps = model::entries(*root, "step");
  if (!steps) return tl::unexpected(model::located(steps.error(), file));
  for (std::size_t i = 0; i < steps->size(); ++i) {
    auto step = step_in(*(*steps)[i], fmt::format("{}, step {}", file, i + 1));
    if (!step) return tl::unexpected(step.error());
    made.steps.push_back(std::move(*step));
  }
  if (auto ok = check(made); !ok) return tl::unexpected(model::located(ok.error(), file));
  return made;
}

}  // namespace prehend::tasks
