#include "common/model/task_kinds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "common/base/parse_file.hpp"
#include "common/base/paths.hpp"
#include "common/base/toml_document.hpp"

namespace prehend::model {

namespace {

constexpr std::size_t max_name = 64;

/// Small letters and digits; whatever else parts words, by one space. A space before and after.
std::string words_of(std::string_view text) {
  std::string made = " ";
  for (const char c : text) {
    const auto letter = static_cast<unsigned char>(c);
    if (std::isalnum(letter))
      made += static_cast<char>(std::tolower(letter));
    else if (made.back() != ' ')
      made += ' ';
  }
  if (made.back() != ' ') made += ' ';
  return made;
}

Expected<TaskKind> read_kind(const toml::table& table) {
  TaskKind made;
  made.name = table["name"].value_or("");
  if (made.name.empty() || made.name.size() > max_name)
    return fail("needs a name of 1 to 64 bytes");
  if (words_of(made.name) != " " + made.name + " ")
    return fail("name is not of small letters and digits, words parted by one space");
  const toml::array* parts = table["keep_free"].as_array();
  if (!parts) return fail("keep_free is no list of " + object_parts.list());
  for (const toml::node& entry : *parts) {
    const auto part = object_parts.value(entry.value_or(std::string_view{}));
    if (!part) return fail("keep_free has what is none of " + object_parts.list());
    made.keep_free.push_back(*part);
  }
  return made;
}

}  // namespace

Expected<TaskKinds> TaskKinds::parse(std::string_view text) {
  const auto document = parse_toml(text, {}, "kinds of tasks are TOML");
  if (!document) return tl::unexpected(document.error());
  const toml::table& root = *document;
  const toml::array* entries = root["task"].as_array();
  if (!entries || entries->empty()) return fail("has no [[task]]", {}, "list at least one");
  TaskKinds made;
  for (const toml::node& entry : *entries) {
    const std::string where = fmt::format("task {}", made.kinds_.size() + 1);
    const toml::table* table = entry.as_table();
    if (!table) return fail("is no table", where, "write [[task]]");
    auto read = read_kind(*table);
    if (!read) return fail(read.error().what, where, "see common/models/tasks/tasks.toml");
    if (std::any_of(made.kinds_.begin(), made.kinds_.end(),
                    [&](const TaskKind& other) { return other.name == read->name; }))
      return fail("two kinds named " + read->name, where);
    made.kinds_.push_back(std::move(*read));
  }
  return made;
}

Expected<TaskKinds> TaskKinds::load(const std::filesystem::path& file) {
  return parse_file(file, &TaskKinds::parse);
}

Expected<TaskKinds> TaskKinds::of_the_house() {
  return load(share_directory() / "models" / "tasks" / "tasks.toml");
}

const TaskKind* TaskKinds::of_task(std::string_view task) const {
  const std::string words = words_of(task);
  const auto found = std::find_if(kinds_.begin(), kinds_.end(), [&](const TaskKind& kind) {
    return words.find(" " + kind.name + " ") != std::string::npos;
  });
  return found == kinds_.end() ? nullptr : &*found;
}

std::vector<ObjectPart> TaskKinds::keep_free(std::string_view task) const {
  const TaskKind* kind = of_task(task);
  return kind ? kind->keep_free : std::vector<ObjectPart>{};
}

}  // namespace prehend::model
