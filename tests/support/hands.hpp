#pragma once

#include <prehend/model/hand_model.hpp>
#include <string>
#include <vector>

namespace prehend::test {

/// All hands of the source tree, sorted: what holds for hands is tested over these.
std::vector<std::string> hand_names();

/// One of them, loaded once. Throws when it cannot be loaded.
const model::HandModel& hand(const std::string& name);

}  // namespace prehend::test
