#pragma once

#include <string>
#include <vector>

namespace prehend::cli {

/// What one check of `prehend doctor` came to.
struct Check {
  std::string name;
  bool ok = true;
  std::string detail;
  std::string hint;  // what to do; empty when nothing is
};
using Findings = std::vector<Check>;

}  // namespace prehend::cli
