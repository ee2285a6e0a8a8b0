#pragma once

#include <string>

#include "services/simulation/tools/hand_import/anatomy.hpp"

namespace prehend::simulation {

/// A text as TOML writes it, in quotes.
std::string toml_text(const std::string& text);

/// A hand.toml that says what was found. name: of the hand.
std::string write_toml(const Anatomy& anatomy, const std::string& name, const Robot& robot);

}  // namespace prehend::simulation
