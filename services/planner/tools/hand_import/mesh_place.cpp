#include "services/planner/tools/hand_import/mesh_place.hpp"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <optional>
#include <sstream>
#include <vector>

namespace prehend::planner {
namespace {

using std::filesystem::path;

constexpr std::size_t searched_entries = 20000;  // of a folder's tree
constexpr int searched_depth = 8;
constexpr std::size_t kept_folders = 16;  // the last ones of a name on somebody's computer
constexpr std::size_t told_places = 6;

/// A name of a mesh, taken apart.
struct Wanted {
  std::string package;  // empty: none
  path file;            // in the package, or as written
};

/// What stands behind a beginning.
std::optional<std::string> behind(const std::string& text, std::string_view beginning) {
  if (!text.starts_with(beginning)) return std::nullopt;
  return text.substr(beginning.size());
}

Wanted in_package(const std::string& rest) {
  const std::size_t slash = rest.find('/');
  if (slash == std::string::npos) return {{}, rest};
  const std::size_t inside = rest.find_first_not_of('/', slash);
  return {rest.substr(0, slash), inside == std::string::npos ? "" : rest.substr(inside)};
}

Wanted taken_apart(std::string name) {
  if (const auto rest = behind(name, "file://")) name = *rest;
  for (const char* scheme : {"package://", "model://"})
    if (const auto rest = behind(name, scheme)) return in_package(*rest);
  for (const char* command : {"$(find ", "$(find-pkg-share "})
    if (const auto rest = behind(name, command))
      if (const std::size_t end = rest->find(')'); end != std::string::npos)
        return in_package(rest->substr(0, end) + rest->substr(end + 1));
  return {{}, name};
}

std::vector<path> folders_of(const char* variable) {
  std::vector<path> folders;
  if (const char* value = std::getenv(variable)) {
    std::istringstream stream(value);
    for (std::string folder; std::getline(stream, folder, ':');)
      if (!folder.empty()) folders.emplace_back(folder);
  }
  return folders;
}

std::vector<path> entries_of(const path& folder) {
  std::vector<path> entries;
  std::error_code failed;
  for (std::filesystem::directory_iterator at(folder, failed), end; !failed && at != end;
       at.increment(failed)) {
    entries.push_back(at->path());
    if (entries.size() >= searched_entries) break;
  }
  std::sort(entries.begin(), entries.end());
  return entries;
}

/// Is the folder that package, by its own name or by its package.xml?
bool is_package(const path& folder, const std::string& name) {
  if (folder.filename() == name) return true;
  std::error_code none;
  const path file = folder / "package.xml";
  if (!std::filesystem::is_regular_file(file, none)) return false;
  tinyxml2::XMLDocument document;
  if (document.LoadFile(file.c_str()) != tinyxml2::XML_SUCCESS) return false;
  const auto* package = document.FirstChildElement("package");
  const auto* named = package ? package->FirstChildElement("name") : nullptr;
  return named && named->GetText() && name == named->GetText();
}

/// The folder and all above it.
std::vector<path> upwards(path folder) {
  std::vector<path> folders{folder};
  for (; folder != folder.parent_path(); folder = folder.parent_path())
    folders.push_back(folder.parent_path());
  return folders;
}

/// Where a mesh may lie, in the order in which places are tried.
class Search {
 public:
  Search(const path& robot_file, const Packages& packages)
      : folder_(std::filesystem::absolute(robot_file).parent_path()), packages_(packages) {}

  Expected<path> find(const Solid& solid) {
    const Wanted wanted = taken_apart(solid.mesh);
    if (!solid.mesh_folder.empty()) {
      offer(folder_ / solid.mesh_folder / wanted.file);
      offer(folder_ / solid.mesh_folder / wanted.file.filename());
    }
    if (!wanted.package.empty())
      offer_package(wanted.package, wanted.file);
    else
      offer(folder_ / wanted.file);
    if (wanted.file.is_absolute()) offer_foreign(wanted.file);
    if (!found_) look_below(folder_, wanted.file.filename());
    if (found_) return *found_;
    return failure(solid.mesh, wanted);
  }

 private:
  void offer(const path& place) {
    std::error_code none;
    if (found_) return;
    if (std::filesystem::is_regular_file(place, none))
      found_ = place;
    else
      tried_.push_back(place);
  }

  void offer_package(const std::string& name, const path& file) {
    if (const auto given = packages_.find(name); given != packages_.end())
      offer(given->second / file);
    for (const path& prefix : folders_of("AMENT_PREFIX_PATH"))
      offer(prefix / "share" / name / file);
    for (const path& root : folders_of("ROS_PACKAGE_PATH")) {
      if (is_package(root, name)) offer(root / file);
      offer(root / name / file);
      for (const path& entry : entries_of(root)) {
        std::error_code none;
        if (found_ || !std::filesystem::is_directory(entry, none)) continue;
        if (is_package(entry, name)) offer(entry / file);
        if (std::filesystem::is_directory(entry / name, none)) offer(entry / name / file);
      }
    }
    for (const path& above : upwards(folder_)) {
      if (is_package(above, name)) offer(above / file);
      offer(above / name / file);
      offer(above / file);  // the package's folder has another name, as after a checkout
    }
  }

  /// A path of somebody else's computer: its folders may be packages, its end may lie here.
  void offer_foreign(const path& file) {
    path rest;
    std::vector<std::pair<std::string, path>> ends;
    for (path at = file; at.has_relative_path() && ends.size() < kept_folders;
         at = at.parent_path()) {
      ends.emplace_back(at.filename().string(), rest);
      rest = rest.empty() ? at.filename() : at.filename() / rest;
    }
    for (const auto& [name, inside_it] : ends) {
      if (inside_it.empty()) continue;
      if (const auto given = packages_.find(name); given != packages_.end())
        offer(given->second / inside_it);
      for (const path& prefix : folders_of("AMENT_PREFIX_PATH"))
        offer(prefix / "share" / name / inside_it);
      for (const path& root : folders_of("ROS_PACKAGE_PATH")) offer(root / name / inside_it);
    }
    for (const path& above : upwards(folder_))
      for (const auto& [name, inside_it] : ends)
        if (!inside_it.empty()) offer(above / name / inside_it);
  }

  void look_below(const path& folder, const path& name) {
    if (name.empty()) return;
    std::vector<path> same;
    std::size_t seen = 0;
    std::error_code failed;
    std::filesystem::recursive_directory_iterator at(
        folder, std::filesystem::directory_options::skip_permission_denied, failed);
    for (const std::filesystem::recursive_directory_iterator end; !failed && at != end;
         at.increment(failed)) {
      if (++seen > searched_entries) return;  // nobody knows whether it is the only one
      if (at.depth() >= searched_depth) at.disable_recursion_pending();
      std::error_code none;
      if (at->path().filename() == name && at->is_regular_file(none)) same.push_back(at->path());
    }
    if (same.size() == 1) found_ = same[0];
    ambiguous_ = std::move(same);
  }

  /// A file where it was looked for, but for the capitals of its name or of folders on the way.
  std::optional<path> with_other_capitals() const {
    const auto lower = [](std::string text) {
      for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      return text;
    };
    for (const path& place : tried_) {
      path at;
      for (const path& part : place.lexically_normal()) {
        std::error_code none;
        path next = at / part;
        if (!std::filesystem::exists(next, none))
          for (const path& entry : entries_of(at))
            if (lower(entry.filename().string()) == lower(part.string())) next = entry;
        at = next;
        if (!std::filesystem::exists(at, none)) break;
      }
      std::error_code none;
      if (std::filesystem::is_regular_file(at, none)) return at;
    }
    return std::nullopt;
  }

  tl::unexpected<Error> failure(const std::string& name, const Wanted& wanted) const {
    if (const auto other = with_other_capitals())
      return fail(fmt::format("is not there, but {} with other capitals is", other->string()), name,
                  "write the name as the file's");
    if (ambiguous_.size() > 1)
      return fail(fmt::format("is not there, and which one is meant: {} or {}?",
                              ambiguous_[0].string(), ambiguous_[1].string()),
                  name, "put the file where the robot's file says");
    std::vector<std::string> places;
    for (const path& place : tried_) {
      const std::string folder = place.lexically_normal().parent_path().string();
      if (std::find(places.begin(), places.end(), folder) == places.end()) places.push_back(folder);
    }
    std::string told;
    for (std::size_t i = 0; i < std::min(places.size(), told_places); ++i)
      told += (i ? ", " : "") + places[i];
    if (places.size() > told_places)
      told += fmt::format(" and {} folders more", places.size() - told_places);
    return fail(
        "is not there", name,
        fmt::format(
            "looked in {}, and for a file of that name below {}{}", told, folder_.string(),
            wanted.package.empty()
                ? "; put the file where the robot's file says"
                : fmt::format("; --package {}=FOLDER says where the package is", wanted.package)));
  }

  const path folder_;
  const Packages& packages_;
  std::optional<path> found_;
  std::vector<path> tried_, ambiguous_;
};

}  // namespace

Expected<path> find_mesh(const Solid& solid, const path& robot_file, const Packages& packages) {
  return Search(robot_file, packages).find(solid);
}

}  // namespace prehend::planner
