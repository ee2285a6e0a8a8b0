#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/recorder/core/dataset/mapped_log.hpp"
#include "services/recorder/tools/dataset/field_path.hpp"

namespace prehend::recorder::dataset {

/// A field of a topic that becomes columns.
struct ColumnsOf {
  std::string name, topic;
  Role role = Role::observation;
  FieldPath field;
  /// Where the names of its elements are, as `name` of sensor_msgs/JointState; nothing: they are
  /// numbered. Elements of later messages are found by their names.
  std::optional<FieldPath> names;
  std::vector<std::string> only;  // elements that are wanted, in this order; empty: all
};

/// A field with compressed pictures.
struct PicturesOf {
  std::string name, topic;
  FieldPath field;
};

/// A topic that says where episodes begin and end.
struct MarksOf {
  std::string topic;
  std::optional<FieldPath> field;  // yes: one begins, no: it ends; none: each message does both
  std::optional<FieldPath> success;
};

/// What columns.toml says: which fields of which topics a policy is shown, and what it should do.
struct ColumnsFile {
  std::string robot, task;
  std::vector<ColumnsOf> columns;
  std::vector<PicturesOf> pictures;
  std::optional<MarksOf> marks;
  double gap = 0;  // s, without actions, that parts episodes; 0: none does
};

/// Refuses with its line whatever it does not know or cannot be.
Expected<ColumnsFile> parse_columns(std::string_view text, const std::string& where);
Expected<ColumnsFile> load_columns(const std::filesystem::path& file);

}  // namespace prehend::recorder::dataset
