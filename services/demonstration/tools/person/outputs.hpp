#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "common/base/random.hpp"
#include "common/service/shell.hpp"
#include "services/demonstration/core/person/person.hpp"

namespace prehend::demonstration {

/// Says at a time what sensors see of a person, who began at another; each on topics that a device
/// of its own would write. The person must outlive it.
using Output = std::function<void(double t, Time stamp)>;

/// A glove with sensors on the back of the hand, thumb, index and little finger: glove/frame.
Output hand_output(service::Shell& shell, const Person& person, std::uint64_t seed);
/// A camera that does not see what is in the hand: object/detection.
Output object_output(service::Shell& shell, const Person& person, std::uint64_t seed);

}  // namespace prehend::demonstration
