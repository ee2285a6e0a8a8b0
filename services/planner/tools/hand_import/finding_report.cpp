#include "services/planner/tools/hand_import/finding_report.hpp"

#include "common/base/to_terminal.hpp"

namespace prehend::planner {

UrdfFinding unreadable(Error error) {
  std::string repair = std::move(error.hint);
  error.hint.clear();
  if (repair.empty()) repair = "a hand or an arm is a URDF, xacro or MJCF";
  return {Severity::error, "not-urdf", "file", 0, error.message(), std::move(repair)};
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
  to_terminal("{}: {}{}: {} [{}]\n  {}\n",
              finding.severity == Severity::error ? "error" : "warning", place, finding.element,
              finding.what, finding.code, finding.repair);
}

}  // namespace prehend::planner
