// `prehend arm add`: a URDF becomes an arm of the lab.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cctype>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/base/file_text.hpp"
#include "common/base/paths.hpp"
#include "common/base/to_terminal.hpp"
#include "services/planner/tools/arm/commands.hpp"
#include "services/planner/tools/arm_import/make_arm.hpp"
#include "services/planner/tools/hand_import/robot_file.hpp"

namespace prehend::planner {
namespace {

struct AddArguments {
  std::string file, name, output, tip;
  bool json = false;
  RobotFileOptions options;
};

Expected<std::filesystem::path> new_folder(const AddArguments& arguments) {
  for (const char c : arguments.name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_' && c != '-')
      return wrong_use("a name has letters, digits, _ and - only", arguments.name);
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(arguments.file, ignored))
    return wrong_use("there is no such file", arguments.file, "is the path right?");
  std::filesystem::path folder = arguments.output;
  if (folder.empty()) {
    for (const std::string& taken : model::arm_names())
      if (taken == arguments.name)
        return wrong_use("there is an arm of this name already", arguments.name,
                         "choose another --name");
    if (data_directory().empty())
      return fail("is not set, so your data have no folder", "HOME",
                  "set it, or use --output FOLDER");
    folder = data_directory() / "models" / "arms" / arguments.name;
  }
  if (std::filesystem::exists(folder / "arm.urdf", ignored))
    return wrong_use("there is an arm already", folder.string(), "remove it, or use --output");
  return folder;
}

Expected<void> write_arm(const MadeArm& arm, const std::filesystem::path& folder) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) return fail(failed.message(), folder.string(), "may you write there?");
  if (auto written = write_file(folder / "arm.urdf", arm.urdf); !written) return written;
  return write_file(folder / "arm.toml", arm.toml);
}

int run_add(const AddArguments& arguments) {
  const auto folder = new_folder(arguments);
  if (!folder) return tool::complain(folder.error());
  const auto robot = read_robot_file(arguments.file, arguments.options);
  if (!robot) return tool::complain(robot.error(), exit_no);
  const auto arm = make_arm(*robot, arguments.name,
                            mesh_files(arguments.file, arguments.options.packages), arguments.tip);
  if (!arm) {
    Error error = arm.error();
    error.where = arguments.file + (error.where.empty() ? "" : ": " + error.where);
    return tool::complain(error, exit_no);
  }
  if (const auto written = write_arm(*arm, *folder); !written)
    return tool::complain(written.error(), exit_broken);
  if (arguments.json) {
    const nlohmann::ordered_json document{{"name", arguments.name},
                                          {"folder", folder->string()},
                                          {"joints", arm->model.joints.size()},
                                          {"changes", arm->changes}};
    std::cout << document.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << "\n";
  } else {
    for (const std::string& change : arm->changes) to_terminal("{}\n", change);
    to_terminal("the arm is in {}; correct arm.toml there where it guessed wrong\n",
                folder->string());
  }
  return exit_done;
}

}  // namespace

void add_add(tool::Program& program) {
  auto arguments = std::make_shared<AddArguments>();
  CLI::App* command = program.app().add_subcommand(
      "add",
      "Makes an arm of the lab from a URDF: a folder with arm.urdf and arm.toml.\n"
      "Exit code 0: made, 1: the URDF is not usable, 2: wrong use.");
  command->add_option("FILE", arguments->file, "a URDF, xacro or MJCF")->required();
  command->add_option("--name", arguments->name, "of the arm")->required();
  command->add_option("--output,-o", arguments->output,
                      "folder for the arm (models/arms/NAME of your data folder)");
  command->add_option("--tip", arguments->tip, "the link at the arm's end");
  command->add_flag("--json", arguments->json, "one JSON document on standard output");
  add_file_options(*command, arguments->options);
  program.on(*command, [arguments] { return run_add(*arguments); });
}

}  // namespace prehend::planner
