#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace prehend::cli {

/// A subcommand that is a program of its own, the offline tool of a service.
struct Tool {
  std::string_view name;     // prehend NAME ...
  std::string_view program;  // beside prehend
  std::string_view help;
};
const std::vector<Tool>& tools();

/// Becomes that program with the given arguments. Returns, with an exit code, only if it cannot.
int become(const Tool& tool, const std::vector<std::string>& arguments);

}  // namespace prehend::cli
