#include "services/planner/tools/hand_import/finding_report.hpp"

#include <fmt/format.h>

#include "common/base/file_text.hpp"

namespace prehend::planner {

Expected<Robot> read_robot_file(const std::filesystem::path& file) {
  const auto text = read_file(file);
  if (!text) return tl::unexpected(text.error());
  auto robot = read_robot(*text);
  if (!robot)
    robot.error().where =
        file.string() + (robot.error().where.empty() ? "" : ": " + robot.error().where);
  return robot;
}

nlohmann::ordered_json to_json(const UrdfFinding& finding) {
  return {{"severity", finding.severity == Severity::error ? "error" : "warning"},
          {"code", finding.code},
          {"element", finding.element},
          {"line", finding.line},
          {"what", finding.what},
          {"mend", finding.repair}};
}

void print(const UrdfFinding& finding) {
  const std::string place = finding.line > 0 ? fmt::format("line {}, ", finding.line) : "";
  fmt::print("{}: {}{}: {} [{}]\n  {}\n", finding.severity == Severity::error ? "error" : "warning",
             place, finding.element, finding.what, finding.code, finding.repair);
}

}  // namespace prehend::planner
