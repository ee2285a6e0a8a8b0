#pragma once

#include <string>

namespace prehend::planner {

enum class Severity {
  warning,  // `prehend hand add` mends or assumes something
  error     // a person must mend it first
};

/// Something missing or suspicious in a URDF.
struct UrdfFinding {
  Severity severity = Severity::error;
  std::string code;     // a stable short name, see README.md
  std::string element;  // «joint f1»
  int line = 0;         // in the file; 0: of the whole
  std::string what;
  std::string repair;
};

}  // namespace prehend::planner
