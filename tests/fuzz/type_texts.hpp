#pragma once

#include <string>
#include <vector>

#include "common/base/random.hpp"
#include "common/recording/types/type.hpp"

namespace prehend::fuzz {

/// The types of idl/.
recording::types::Library contract();

/// Bytes, numbers and lines of the text are changed, or one of the pieces is put in, once or very
/// often: deep nesting finds readers that recurse without end.
std::string mutate_type_text(Random& random, std::string text,
                             const std::vector<std::string>& pieces);

/// Decodes a few messages, all zero and all 1, of some lengths; throws when a value that was
/// decoded does not have the type's fields.
void decode_some(const recording::types::Structure& type);

}  // namespace prehend::fuzz
