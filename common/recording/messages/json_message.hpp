#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <string>

#include "common/base/error.hpp"
#include "common/recording/types/value.hpp"

namespace prehend::recording {

/// Names of fields that no type has: each once.
using Names = std::set<std::string, std::less<>>;

/// A message in JSON, an object. What is null is not there. Fails on what is none, and on one that
/// lies too deep inside itself. Names of fields live in `names`.
Expected<types::Value> json_message(std::span<const std::uint8_t> message, Names& names);

}  // namespace prehend::recording
