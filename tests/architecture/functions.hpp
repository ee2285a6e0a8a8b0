#pragma once

#include <string>
#include <vector>

#include "tests/architecture/house.hpp"

namespace prehend::architecture {

/// Lines, from 0, from the first of the signature to the bracket that closes it.
struct Function {
  std::size_t begin = 0, end = 0;
  std::size_t column = 0;  // 0: of a namespace; else within a class or another function
  std::string signature;
};

/// All that are longer than a line, at any indent: also members that are defined in their class,
/// and lambdas with a name. What is within another comes after it.
std::vector<Function> functions_of(const File& file);

}  // namespace prehend::architecture
