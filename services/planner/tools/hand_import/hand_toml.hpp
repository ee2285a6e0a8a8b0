#pragma once

#include <string>

#include "services/planner/tools/hand_import/anatomy.hpp"

namespace prehend::planner {

/// A text as TOML writes it, in quotes.
std::string toml_text(const std::string& text);

/// A hand.toml that says what was found. name: of the hand.
std::string write_toml(const Anatomy& anatomy, const std::string& name, const Robot& robot);

}  // namespace prehend::planner
