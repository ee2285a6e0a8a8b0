#pragma once

#include <filesystem>
#include <string>

#include "common/base/error.hpp"
#include "services/demonstration/core/tasks/task_model.hpp"

namespace prehend::demonstration {

/// A task in a sealed file (kind «task»). Refused: what is damaged, something else, or no sound
/// task.
Expected<void> save_task(const std::filesystem::path& file, const TaskModel& task);
Expected<TaskModel> load_task(const std::filesystem::path& file);

/// A task to be read by people: TOML, lengths in m, angles in degrees.
std::string to_toml(const TaskModel& task);

}  // namespace prehend::demonstration
