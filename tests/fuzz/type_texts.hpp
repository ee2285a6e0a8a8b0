#pragma once

#include <prehend/base/random.hpp>
#include <prehend/types/type.hpp>
#include <string>
#include <vector>

namespace prehend::fuzz {

/// The types of idl/.
types::Library contract();

/// Bytes, numbers and lines of the text are changed, or one of the pieces is put in, once or very
/// often: deep nesting finds readers that recurse without end.
std::string mutate_type_text(Random& random, std::string text,
                             const std::vector<std::string>& pieces);

/// Decodes a few messages, all zero and all 1, of some lengths; throws when a value that was
/// decoded does not have the type's fields.
void decode_some(const types::Structure& type);

}  // namespace prehend::fuzz
