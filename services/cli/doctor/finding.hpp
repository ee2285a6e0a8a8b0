#pragma once

#include <string>
#include <vector>

namespace prehend::cli {

/// What one check of `prehend doctor` came to.
struct Finding {
  std::string name;
  bool ok = true;
  std::string detail;
  std::string mend;  // what to do; empty when nothing is
};
using Findings = std::vector<Finding>;

}  // namespace prehend::cli
