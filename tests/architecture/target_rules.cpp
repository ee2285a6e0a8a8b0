// Folders as targets of the build, and services as folders.
#include <algorithm>
#include <array>

#include "tests/architecture/rules.hpp"

namespace prehend::architecture {
namespace {

bool is_in_the_build(std::string_view path) {
  return path.starts_with("common/") || path.starts_with("services/");
}

std::string target_name(std::string folder) {
  std::replace(folder.begin(), folder.end(), '/', '_');
  return folder;
}

bool is_folder_target(std::string_view target) {
  return target == "idl" || target.starts_with("common_") || target.starts_with("services_");
}

/// A folder's sources and what its CMakeLists.txt makes of them.
struct FolderOfSources {
  std::vector<const File*> headers, sources, mains;
};

class Targets {
 public:
  explicit Targets(const House& house) {
    for (const auto& [folder, build] : house.build)
      if (!build.libraries.empty()) libraries_[target_name(folder)] = &build.libraries.front();
  }

  bool has(const std::string& target) const {
    return target == "idl" || libraries_.contains(target);
  }

  /// The targets and what they bring along to whoever links them.
  std::set<std::string> with_public(std::vector<std::string> open) const {
    std::set<std::string> all;
    while (!open.empty()) {
      const std::string target = open.back();
      open.pop_back();
      if (!all.insert(target).second) continue;
      const auto library = libraries_.find(target);
      if (library != libraries_.end())
        open.insert(open.end(), library->second->link.begin(), library->second->link.end());
    }
    return all;
  }

 private:
  std::map<std::string, const Target*> libraries_;
};

std::map<std::string, FolderOfSources> folders_of(const House& house) {
  std::map<std::string, FolderOfSources> folders;
  for (const File& file : house.sources) {
    if (!is_in_the_build(file.path)) continue;
    FolderOfSources& folder = folders[folder_of(file.path)];
    if (file.path.ends_with(".hpp")) {
      folder.headers.push_back(&file);
    } else {
      (file.path.ends_with("/main.cpp") ? folder.mains : folder.sources).push_back(&file);
    }
  }
  return folders;
}

void report_unlinked(const std::vector<const File*>& files, const std::string& folder,
                     const std::set<std::string>& linked, std::string_view where,
                     std::set<std::string>* needed, Violations& violations) {
  for (const File* file : files)
    for (const Include& include : file->includes) {
      const std::string target = target_name(folder_of(include.path));
      if (!include.quoted || !is_folder_target(target) || target == target_name(folder)) continue;
      if (needed) needed->insert(target);
      if (!linked.contains(target))
        violations.push_back(
            {file->path, include.line, "its target lacks " + target + " in " + std::string(where)});
    }
}

void report_library(const std::string& folder, const FolderOfSources& files, const Target& library,
                    const Targets& targets, Violations& violations) {
  const std::string path = folder + "/CMakeLists.txt";
  std::vector<std::string> all = library.link;
  all.insert(all.end(), library.private_link.begin(), library.private_link.end());
  std::set<std::string> needed;
  report_unlinked(files.headers, folder, {library.link.begin(), library.link.end()}, "LINK",
                  &needed, violations);
  report_unlinked(files.sources, folder, targets.with_public(all), "LINK or PRIVATE", &needed,
                  violations);
  if (!library.name.empty())
    violations.push_back({path, library.line, "a library is named by its folder"});
  for (const std::string& target : all) {
    if (!is_folder_target(target) || target == "common_proto_messages") continue;
    if (!targets.has(target)) {
      violations.push_back({path, library.line, "no folder makes " + target});
    } else if (!needed.contains(target)) {
      violations.push_back({path, library.line, "no source of the library includes " + target});
    }
  }
}

void report_program(const std::string& folder, const FolderOfSources& files, const BuildFile& build,
                    const Targets& targets, Violations& violations) {
  const Target& program = build.programs.front();
  std::vector<std::string> linked = program.link;
  if (!build.libraries.empty()) linked.push_back(target_name(folder));
  report_unlinked(files.mains, folder, targets.with_public(linked), "the program's LINK", nullptr,
                  violations);
}

void report_folder(const std::string& folder, const FolderOfSources& files, const House& house,
                   const Targets& targets, Violations& violations) {
  const auto build = house.build.find(folder);
  const std::string path = folder + "/CMakeLists.txt";
  if (build == house.build.end()) {
    if (!files.sources.empty() || !files.mains.empty() || !files.headers.empty())
      violations.push_back({path, 1, "a folder with sources has no CMakeLists.txt"});
    return;
  }
  const std::vector<Target>& libraries = build->second.libraries;
  const std::vector<Target>& programs = build->second.programs;
  const auto expect = [&](const std::vector<Target>& made, std::size_t count, std::string_view of) {
    if (made.size() == count) return;
    violations.push_back({path, made.empty() ? 1 : made.back().line,
                          "makes " + std::to_string(made.size()) + " " + std::string(of) +
                              ", and has sources for " + std::to_string(count)});
  };
  expect(libraries, files.sources.empty() ? 0 : 1, "libraries");
  expect(programs, files.mains.size(), "programs");
  if (!libraries.empty()) report_library(folder, files, libraries.front(), targets, violations);
  if (!programs.empty()) report_program(folder, files, build->second, targets, violations);
}

constexpr std::array layers{"cameras", "core", "devices", "files", "service", "tools"};

struct DataFolder {
  std::string_view service, folder;
};
constexpr std::array data_folders{DataFolder{"services/mapping", "trained"},
                                  DataFolder{"services/mapping", "schemes"}};

// Beside folders and files whose names begin with a dot, which tools want there.
constexpr std::array files_of_the_root{"ARCHITECTURE.md",   "CMakeLists.txt", "CMakePresets.json",
                                       "LICENSE",           "README.md",      "REFERENCES.md",
                                       "docker-compose.yml"};

bool is_part_of_a_service(std::string_view service, std::string_view name) {
  return std::find(layers.begin(), layers.end(), name) != layers.end() ||
         std::any_of(data_folders.begin(), data_folders.end(), [&](const DataFolder& data) {
           return data.service == service && data.folder == name;
         });
}

}  // namespace

Violations broken_targets(const House& house, const Agreed& agreed) {
  Violations violations;
  const Targets targets(house);
  for (const auto& [folder, files] : folders_of(house))
    report_folder(folder, files, house, targets, violations);
  Exceptions exceptions(agreed.raw_targets);
  for (const auto& [folder, build] : house.build)
    for (const Target& raw : build.raw) {
      const std::string path = folder + "/CMakeLists.txt";
      if (is_in_the_build(path) && !exceptions.allow(path, raw.name))
        violations.push_back({path, raw.line, raw.name + " is made by hand"});
    }
  exceptions.report_unused(violations);
  return violations;
}

Violations unlike_services(const House& house, const Agreed&) {
  Violations violations;
  for (const std::string& path : house.paths) {
    if (!path.starts_with("services/")) continue;
    const std::string service = first_names(path, 2);
    if (path == service) {
      if (!house.paths.contains(path + "/README.md"))
        violations.push_back({path + "/README.md", 1, "a service has no page"});
      continue;
    }
    const std::string name = path.substr(service.size() + 1);
    if (name == "README.md" || name.find('/') != std::string::npos) continue;
    if (!is_part_of_a_service(service, name))
      violations.push_back({path, 1, "is no part that services have"});
  }
  return violations;
}

Violations strays_at_the_root(const House& house, const Agreed&) {
  Violations violations;
  for (const std::string& path : house.paths)
    if (path.find('/') == std::string::npos &&
        std::find(top_folders.begin(), top_folders.end(), path) == top_folders.end() &&
        !path.starts_with('.') &&
        std::find(files_of_the_root.begin(), files_of_the_root.end(), path) ==
            files_of_the_root.end())
      violations.push_back({path, 1, "has no place at the root"});
  return violations;
}

}  // namespace prehend::architecture
