#pragma once

#include <functional>

namespace prehend::tool {

/// Runs a program and returns its exit code; every main() goes through here. What was printed and
/// did not reach standard output, since its disk is full or nobody reads it, is an error whatever
/// the program itself answered: who pipes a document into a file must not take half of it for all.
int with_whole_output(const std::function<int()>& run);

}  // namespace prehend::tool
