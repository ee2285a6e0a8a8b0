#pragma once

#include <prehend/base/random.hpp>
#include <prehend/types/value.hpp>
#include <vector>

namespace prehend::testing {

/// A value of the type with random contents within its bounds: short collections, the borders of
/// the number ranges among the numbers.
types::Value random_value(const types::Structure& type, Random& random);

/// XCDR1 with its encapsulation header, in the byte order asked for. Written for the tests, beside
/// the decoder and apart from it.
std::vector<std::uint8_t> encode(const types::Structure& type, const types::Value& value,
                                 bool big_endian = false);

}  // namespace prehend::testing
