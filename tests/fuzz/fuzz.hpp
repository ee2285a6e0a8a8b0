#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/base/random.hpp"

namespace prehend::fuzz {

/// What is fuzzed, and how.
struct Fuzzer {
  std::vector<std::string> seeds;  // good inputs, at least one
  /// An input made from a good one. Everything random comes from the argument.
  std::function<std::string(Random&, std::string)> mutate;
  /// Reads the input and throws std::logic_error when what came out must not be. True: accepted.
  std::function<bool(const std::string&)> target;
  /// So many inputs are tried in the long round, however long that takes.
  std::uint64_t long_round = 0;
};

/// main() of a fuzzer: try k is made from Random(k), so that every run tries the same inputs, for
/// 3 s, or 60 s if PREHEND_LONG is set. The target runs in a child process; if that crashes,
/// throws, or needs more than 20 s for one input, the input is kept in a file that is named, and
/// the result is 1. Also 1 when no mutated input is accepted or none refused: such a fuzzer sees
/// nothing.
///   [--seconds N] [--first K]   another duration; the first try
///   FILE...                     these inputs only, as they are
int run(const Fuzzer& fuzzer, int argc, char** argv);

/// Throws what run() reports as a failure.
void require(bool condition, const std::string& what);

/// The whole file. Throws if it cannot be read.
std::string read_file(const std::string& path);

}  // namespace prehend::fuzz
