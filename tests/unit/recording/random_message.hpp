#pragma once

#include <vector>

#include "common/base/random.hpp"
#include "common/recording/types/value.hpp"

namespace prehend::testing {

/// A value of the type with random contents within its bounds: short collections, the borders of
/// the number ranges among the numbers.
recording::types::Value random_value(const recording::types::Structure& type, Random& random);

/// XCDR1 with its encapsulation header, in the byte order asked for. Written for the tests, beside
/// the decoder and apart from it.
std::vector<std::uint8_t> encode(const recording::types::Structure& type,
                                 const recording::types::Value& value, bool big_endian = false);

}  // namespace prehend::testing
