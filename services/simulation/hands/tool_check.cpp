// `prehend hand check`: what is missing or suspicious in a URDF.
#include <fmt/format.h>

#include <fstream>
#include <iostream>
#include <memory>
#include <prehend/base/log.hpp>
#include <sstream>

#include "make_hand.hpp"
#include "tool.hpp"

namespace prehend::hands {
namespace {

int run_check(const std::string& file, bool json) {
  if (std::error_code ignored; !std::filesystem::is_regular_file(file, ignored)) {
    log::error("{}: there is no such file", file);
    return 2;
  }
  std::vector<Finding> findings;
  const auto robot = read_robot_file(file);
  if (robot) {
    const MeshReader meshes = mesh_files(file);
    findings = check(*robot, meshes);
    // What only shows when a hand is made of it: too many DoFs, no fingers.
    if (is_usable(findings))
      if (const auto hand = make_hand(*robot, robot->name.empty() ? "hand" : robot->name, meshes);
          !hand)
        findings.insert(findings.begin(), {Severity::error, "no-hand", "robot " + robot->name, 0,
                                           hand.error().message(), hand.error().mend});
  } else {
    findings.push_back(
        {Severity::error, "not-urdf", "file", 0, robot.error().message(), robot.error().mend});
  }
  const bool usable = is_usable(findings);
  if (json) {
    nlohmann::ordered_json document{{"file", file}, {"usable", usable}};
    document["findings"] = nlohmann::ordered_json::array();
    for (const Finding& finding : findings) document["findings"].push_back(to_json(finding));
    std::cout << document.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << "\n";
  } else {
    for (const Finding& finding : findings) print(finding);
    fmt::print("{}: {}, {} finding{}\n", file, usable ? "usable" : "not usable", findings.size(),
               findings.size() == 1 ? "" : "s");
  }
  return usable ? 0 : 1;
}

}  // namespace

Expected<Robot> read_robot_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  if (!stream || !(text << stream.rdbuf())) return fail("cannot be read", file.string());
  auto robot = read_robot(text.str());
  if (!robot)
    robot.error().where =
        file.string() + (robot.error().where.empty() ? "" : ": " + robot.error().where);
  return robot;
}

nlohmann::ordered_json to_json(const Finding& finding) {
  return {{"severity", finding.severity == Severity::error ? "error" : "warning"},
          {"code", finding.code},
          {"element", finding.element},
          {"line", finding.line},
          {"what", finding.what},
          {"mend", finding.mend}};
}

void print(const Finding& finding) {
  const std::string place = finding.line > 0 ? fmt::format("line {}, ", finding.line) : "";
  fmt::print("{}: {}{}: {} [{}]\n  {}\n", finding.severity == Severity::error ? "error" : "warning",
             place, finding.element, finding.what, finding.code, finding.mend);
}

void add_check(CLI::App& app, int& exit_code) {
  auto file = std::make_shared<std::string>();
  auto json = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand(
      "check",
      "Lists what is missing or suspicious in a URDF that shall be a hand, each with its mend.\n"
      "Exit code 0: usable, perhaps with warnings, 1: not usable, 2: wrong use.");
  command->add_option("FILE", *file, "a URDF")->required();
  command->add_flag("--json", *json, "one JSON document on standard output");
  command->callback([file, json, &exit_code] { exit_code = run_check(*file, *json); });
}

}  // namespace prehend::hands
