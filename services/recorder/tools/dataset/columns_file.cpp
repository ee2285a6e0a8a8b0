#include "services/recorder/tools/dataset/columns_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "common/base/file_text.hpp"
#include "common/base/toml_document.hpp"
#include "services/recorder/tools/dataset/message.hpp"

namespace prehend::recorder::dataset {
namespace {

constexpr const char* hint = "docs/training-data.md has an example";
constexpr double max_gap = 1e6;  // s
constexpr std::size_t max_only = 4096;

/// One table of the file: its keys, checked.
class Entry {
 public:
  Entry(const toml::table& table, const std::string& where) : table_(table), where_(where) {}

  Expected<void> only_keys(std::initializer_list<std::string_view> known) const {
    for (const auto& [key, node] : table_)
      if (std::ranges::find(known, key.str()) == known.end())
        return refuse(fmt::format("{} is not known here", key.str()), &node);
    return {};
  }
  Expected<std::string> text(std::string_view key) const {
    const toml::node* node = table_.get(key);
    if (!node) return refuse(fmt::format("{} is missing", key));
    const auto value = node->value_exact<std::string>();
    if (!value || value->empty()) return refuse(fmt::format("{} is no text", key), node);
    return *value;
  }
  Expected<std::optional<FieldPath>> path(std::string_view key) const {
    if (!table_.contains(key)) return std::optional<FieldPath>();
    const auto words = text(key);
    if (!words) return tl::unexpected(words.error());
    auto made = FieldPath::parse(*words);
    if (!made) return refuse(made.error().what, table_.get(key));
    return std::optional(std::move(*made));
  }
  /// One that must be there.
  Expected<FieldPath> field(std::string_view key) const {
    auto made = path(key);
    if (!made) return tl::unexpected(made.error());
    if (!*made) return refuse(fmt::format("{} is missing", key));
    return std::move(**made);
  }
  Expected<std::vector<std::string>> texts(std::string_view key) const {
    std::vector<std::string> all;
    const toml::node* node = table_.get(key);
    if (!node) return all;
    const toml::array* list = node->as_array();
    if (list && list->size() <= max_only)
      for (const toml::node& each : *list)
        if (const auto value = each.value_exact<std::string>()) all.push_back(*value);
    if (!list || list->empty() || all.size() != list->size())
      return refuse(fmt::format("{} is no list of texts", key), node);
    return all;
  }
  tl::unexpected<Error> refuse(const std::string& what, const toml::node* node = nullptr) const {
    return fail(what,
                fmt::format("{}: line {}", where_, (node ? *node : table_).source().begin.line),
                hint, exit_wrong_use);
  }
  const toml::table& table() const { return table_; }

 private:
  const toml::table& table_;
  const std::string& where_;
};

class Reader {
 public:
  Reader(const toml::table& root, const std::string& where) : root_(root), where_(where) {}

  Expected<ColumnsFile> read() {
    const Entry top(root_, where_);
    if (auto ok = top.only_keys(
            {"robot", "task", "state", "action", "observation", "picture", "episodes"});
        !ok)
      return tl::unexpected(ok.error());
    for (const auto& [key, to] :
         {std::pair("robot", &made_.robot), std::pair("task", &made_.task)}) {
      if (!root_.contains(key)) continue;
      auto text = top.text(key);
      if (!text) return tl::unexpected(text.error());
      *to = std::move(*text);
    }
    for (const auto& [key, role] :
         {std::pair("state", Role::state), std::pair("action", Role::action),
          std::pair("observation", Role::observation)})
      if (auto ok = each(key, [&](const Entry& entry) { return column(entry, role); }); !ok)
        return tl::unexpected(ok.error());
    if (auto ok = each("picture", [&](const Entry& entry) { return picture(entry); }); !ok)
      return tl::unexpected(ok.error());
    if (auto ok = episodes(); !ok) return tl::unexpected(ok.error());
    for (const auto& [role, name] :
         {std::pair(Role::state, "state"), std::pair(Role::action, "action")})
      if (std::ranges::none_of(made_.columns, [&](const auto& c) { return c.role == role; }))
        return top.refuse(fmt::format("[[{}]] is missing", name));
    return std::move(made_);
  }

 private:
  /// The tables of [[key]].
  template <class Take>
  Expected<void> each(std::string_view key, const Take& take) {
    const toml::node* node = root_.get(key);
    if (!node) return {};
    const toml::array* array = node->as_array();
    if (!array) return Entry(root_, where_).refuse(fmt::format("write [[{}]]", key), node);
    for (const toml::node& one : *array) {
      const toml::table* table = one.as_table();
      if (!table) return Entry(root_, where_).refuse(fmt::format("write [[{}]]", key), &one);
      if (auto ok = take(Entry(*table, where_)); !ok) return ok;
    }
    return {};
  }

  /// Names become names of columns, groups and files.
  Expected<std::string> new_name(const Entry& entry) {
    auto name = entry.text("name");
    if (!name) return name;
    if (as_name(*name) != *name || name->size() > 64)
      return entry.refuse("a name has up to 64 letters, digits, _ and -",
                          entry.table().get("name"));
    if (*name == "state" || *name == "action" || !names_.insert(*name).second)
      return entry.refuse(*name + " is there twice", entry.table().get("name"));
    return name;
  }

  Expected<void> column(const Entry& entry, Role role) {
    const bool named = role == Role::observation;
    if (auto ok = named ? entry.only_keys({"name", "topic", "field", "names", "only"})
                        : entry.only_keys({"topic", "field", "names", "only"});
        !ok)
      return ok;
    auto name =
        named ? new_name(entry) : Expected<std::string>(role == Role::state ? "state" : "action");
    auto topic = entry.text("topic");
    auto field = entry.field("field");
    auto names = entry.path("names");
    auto only = entry.texts("only");
    if (!name) return tl::unexpected(name.error());
    if (!topic) return tl::unexpected(topic.error());
    if (!field) return tl::unexpected(field.error());
    if (!names) return tl::unexpected(names.error());
    if (!only) return tl::unexpected(only.error());
    made_.columns.push_back({std::move(*name), std::move(*topic), role, std::move(*field),
                             std::move(*names), std::move(*only)});
    return {};
  }

  Expected<void> picture(const Entry& entry) {
    if (auto ok = entry.only_keys({"name", "topic", "field"}); !ok) return ok;
    auto name = new_name(entry);
    auto topic = entry.text("topic");
    auto field = entry.field("field");
    if (!name) return tl::unexpected(name.error());
    if (!topic) return tl::unexpected(topic.error());
    if (!field) return tl::unexpected(field.error());
    made_.pictures.push_back({std::move(*name), std::move(*topic), std::move(*field)});
    return {};
  }

  Expected<void> episodes() {
    const toml::node* node = root_.get("episodes");
    if (!node) return {};
    const toml::table* table = node->as_table();
    if (!table) return Entry(root_, where_).refuse("write [episodes]", node);
    const Entry entry(*table, where_);
    if (auto ok = entry.only_keys({"topic", "field", "success", "gap"}); !ok) return ok;
    const bool by_gap = table->contains("gap"), by_topic = table->contains("topic");
    if (by_gap == by_topic) return entry.refuse("either a topic or a gap parts episodes");
    if (by_gap) {
      const auto gap = (*table)["gap"].value<double>();
      if (!gap || !(*gap > 0 && *gap <= max_gap) || table->size() > 1)
        return entry.refuse(fmt::format("gap is above 0 and at most {:g} s, alone", max_gap),
                            table->get("gap"));
      made_.gap = *gap;
      return {};
    }
    auto topic = entry.text("topic");
    auto field = entry.path("field"), success = entry.path("success");
    if (!topic) return tl::unexpected(topic.error());
    if (!field) return tl::unexpected(field.error());
    if (!success) return tl::unexpected(success.error());
    made_.marks = MarksOf{std::move(*topic), std::move(*field), std::move(*success)};
    return {};
  }

  const toml::table& root_;
  const std::string& where_;
  ColumnsFile made_;
  std::set<std::string> names_;
};

}  // namespace

Expected<ColumnsFile> parse_columns(std::string_view text, const std::string& where) {
  const auto root = parse_toml(text, where, hint);
  if (!root) return fail(root.error().what, root.error().where, hint, exit_wrong_use);
  return Reader(*root, where).read();
}

Expected<ColumnsFile> load_columns(const std::filesystem::path& file) {
  const auto text = read_file(file);
  if (!text) return tl::unexpected(text.error());
  return parse_columns(*text, file.string());
}

}  // namespace prehend::recorder::dataset
