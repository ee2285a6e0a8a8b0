#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/model/grasp_taxonomy.hpp"

namespace prehend::model {

/// What tasks of one kind ask of a grasp.
struct TaskKind {
  std::string name;                   // small letters, words parted by one space
  std::vector<ObjectPart> keep_free;  // parts of the object that the hand may not lie on
};

/// Kinds of tasks, from models/tasks/tasks.toml.
class TaskKinds {
 public:
  static Expected<TaskKinds> load(const std::filesystem::path& file);
  static Expected<TaskKinds> parse(std::string_view toml);
  /// Those that come with us.
  static Expected<TaskKinds> of_the_house();

  const std::vector<TaskKind>& kinds() const { return kinds_; }
  /// The kind whose name stands as words in the task's: «Pour-tea 2» pours. The first of several;
  /// nullptr if there is none.
  const TaskKind* of_task(std::string_view task) const;
  /// What this task needs free; nothing of a task of no kind.
  std::vector<ObjectPart> keep_free(std::string_view task) const;

 private:
  std::vector<TaskKind> kinds_;
};

}  // namespace prehend::model
