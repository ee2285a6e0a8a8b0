#pragma once

#include <string>

#include "common/base/error.hpp"
#include "common/model/hand_model.hpp"
#include "services/mapping/files/model_places.hpp"

namespace prehend::mapping {

/// What is asked of a hand that nobody has trained yet.
enum class Needs { model, model_and_grasps };

/// Where what was made for a hand lies. What is missing, damaged or made for the hand as it was
/// before is made first, in seconds, with a scheme that is its own or derived; one line says so,
/// another what was made. Of hands that come with us only what is missing is made. Several
/// processes may do so at once: they make the same, and files appear whole.
Expected<ModelPlaces> ready_places(const std::string& hand, const model::HandModel& model,
                                   Needs needs);

}  // namespace prehend::mapping
