#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "common/tasks/shown_task.hpp"
#include "common/tasks/task_model.hpp"

namespace prehend::tasks {

/// A robot did a task, or failed.
struct TaskRun {
  Time stamp{};
  std::string hand;  // its kind
  bool done = false;
  std::string reason;  // why it is not done
};

/// All that is known of a task.
struct TaskRecord {
  TaskModel task;
  std::vector<ShownTask> shown = {};  // what it was learnt from; more are learnt with these
  std::vector<TaskRun> runs = {};     // the newest last, at most 100
};

/// A task in a sealed file (kind «task»). Refused: what is damaged, something else, or no sound
/// task.
Expected<void> save_task(const std::filesystem::path& file, const TaskModel& task);
Expected<TaskModel> load_task(const std::filesystem::path& file);
Expected<void> save_record(const std::filesystem::path& file, const TaskRecord& record);
Expected<TaskRecord> load_record(const std::filesystem::path& file);

/// The file of a task: a path, or a name in the folder of tasks. Fails on a name that is no name of
/// a file, and where there is no folder.
Expected<std::filesystem::path> task_path(const std::string& task,
                                          const std::filesystem::path& folder);
/// The folder that is named, or else that of the user.
std::filesystem::path task_folder(const std::string& named);

/// A task to be read by people: TOML, lengths in m, angles in degrees.
std::string to_toml(const TaskModel& task);
/// The same back, as somebody has changed it. Errors name the file and the step.
Expected<TaskModel> from_toml(std::string_view text, const std::string& file);

}  // namespace prehend::tasks
