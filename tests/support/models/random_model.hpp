#pragma once

#include <cstdint>

#include "services/mapping/core/mapping_model.hpp"

namespace prehend::test {

/// A network of random weights over the range of hand features: whatever it answers, the mapping
/// around it must keep its promises. shape unknown: direct. Told the characteristic size.
mapping::MappingNetwork random_network(const model::HandModel& hand, model::ShapeKind shape,
                                       std::uint64_t seed, int hidden = 8);

/// Traits of a model that keeps to the hand's own limits.
mapping::ModelTraits plain_traits(const model::HandModel& hand);

/// Of such networks: direct, cylinder and box.
mapping::MappingModel random_model(const model::HandModel& hand, std::uint64_t seed,
                                   int hidden = 8);

}  // namespace prehend::test
