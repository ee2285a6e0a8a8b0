#pragma once

#include <cstdint>

#include "common/model/catalogue.hpp"

namespace prehend::mapping {

/// Things that nobody has trained with: cylinders, boxes, spheres and cones, 10 to 90 mm wide
/// between the fingers and 50 to 220 mm high, of any weight and material that such things have.
/// Another seed, other things.
model::Catalogue drawn_objects(int count, std::uint64_t seed);

}  // namespace prehend::mapping
