#pragma once

#include <string>
#include <vector>

#include "common/model/hand_model.hpp"

namespace prehend::fuzz {

/// The two files of a hand in common/models/hands.
struct HandFiles {
  std::string urdf, toml;
};
std::vector<HandFiles> all_hands();

/// What every hand that was accepted must be: finite, whatever its joints do.
void require_sound(const model::HandModel& hand);

}  // namespace prehend::fuzz
