#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/model/hand_model.hpp"

namespace prehend::test {

/// All hands of the source tree, sorted: what holds for hands is tested over these.
std::vector<std::string> hand_names();

/// Those that human hands are mapped to, sorted: there is a scheme of their name.
std::vector<std::string> mappable_hands();

/// One of them, loaded once. Throws when it cannot be loaded.
const model::HandModel& hand(std::string_view name);

/// One of them with this coupling (of hand.toml) in every DoF. Throws as hand() does.
model::HandModel coupled_hand(const std::string& name, const std::string& coupling);

}  // namespace prehend::test
