#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "common/base/random.hpp"
#include "common/model/catalogue.hpp"
#include "common/service/shell.hpp"
#include "idl/World.h"
#include "services/demonstration/core/person/person.hpp"

namespace prehend::demonstration {

/// Says at a time what sensors see of a person, who began at another; each on topics that a device
/// of its own would write. The person must outlive it.
using Output = std::function<void(double t, Time stamp)>;

/// A glove with sensors on the back of the hand, thumb, index and little finger: glove/frame.
Output hand_output(service::Shell& shell, const Person& person, std::uint64_t seed);
/// A camera that does not see what is in the hand: object/detection.
Output object_output(service::Shell& shell, const Person& person, std::uint64_t seed);

/// Cameras that see the markers on what the simulation moves, also in a hand: object/detection. The
/// catalogue, which must outlive it, knows shapes and sizes.
using MarkerOutput = std::function<void(const v1::ObjectState& state)>;
MarkerOutput marker_output(service::Shell& shell, const model::Catalogue& catalogue,
                           std::uint64_t seed);

}  // namespace prehend::demonstration
