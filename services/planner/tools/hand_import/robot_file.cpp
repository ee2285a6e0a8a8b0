#include "services/planner/tools/hand_import/robot_file.hpp"

#include <CLI/CLI.hpp>

#include "common/base/file_text.hpp"
#include "services/planner/tools/hand_import/mjcf.hpp"
#include "services/planner/tools/hand_import/xacro.hpp"

namespace prehend::planner {
namespace {

void add_package(const std::string& text, Packages& packages) {
  const std::size_t equals = text.find('=');
  if (equals == 0 || equals == std::string::npos || equals + 1 == text.size())
    throw CLI::ValidationError("--package", text + ": is NAME=FOLDER");
  std::error_code none;
  const std::filesystem::path folder = text.substr(equals + 1);
  if (!std::filesystem::is_directory(folder, none))
    throw CLI::ValidationError("--package", folder.string() + ": there is no such folder");
  packages[text.substr(0, equals)] = folder;
}

}  // namespace

void add_file_options(CLI::App& command, RobotFileOptions& options) {
  command
      .add_option_function<std::vector<std::string>>(
          "--package",
          [&options](const std::vector<std::string>& all) {
            for (const std::string& each : all) add_package(each, options.packages);
          },
          "NAME=FOLDER: where a package of package://NAME/… is; may be repeated")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command
      .add_option("--xacro", options.xacro,
                  "NAME:=VALUE: an argument of a xacro file; may be repeated")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

Expected<Robot> read_robot_file(const std::filesystem::path& file,
                                const RobotFileOptions& options) {
  auto text = read_file(file);
  if (text && is_xacro(*text)) text = expand_xacro(file, options.xacro);
  if (!text) return tl::unexpected(text.error());
  // MuJoCo's files name those that they include by their place beside the outermost.
  const IncludeReader beside = [&](const std::string& name) {
    const auto place = std::filesystem::absolute(file).parent_path() / name;
    std::error_code none;
    if (!std::filesystem::is_regular_file(place, none))
      return Expected<std::string>(fail("there is no such file", place.string()));
    return read_file(place);
  };
  auto robot = is_mjcf(*text) ? read_mjcf(*text, beside) : read_robot(*text);
  if (!robot)
    robot.error().where =
        file.string() + (robot.error().where.empty() ? "" : ": " + robot.error().where);
  return robot;
}

}  // namespace prehend::planner
