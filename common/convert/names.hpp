#pragma once

#include "common/base/named_values.hpp"
#include "idl/Demonstration.h"
#include "idl/Robot.h"

/// What values of the messages are called in JSON.
namespace prehend::convert {

inline constexpr auto mode_names = named_values<v1::MappingMode>(
    {{v1::MODE_HOLD, "hold"}, {v1::MODE_DIRECT, "direct"}, {v1::MODE_INTELLIGENT, "intelligent"}});

inline constexpr auto grasp_names =
    named_values<v1::GraspType>({{v1::GRASP_NONE, "none"},
                                 {v1::GRASP_POWER_WRAP, "power_wrap"},
                                 {v1::GRASP_CIRCULAR_SPHERE, "circular_sphere"},
                                 {v1::GRASP_PRECISION, "precision"}});

inline constexpr auto phase_names = named_values<v1::HandPhase>({{v1::PHASE_REST, "rest"},
                                                                 {v1::PHASE_APPROACH, "approach"},
                                                                 {v1::PHASE_CLOSE, "close"},
                                                                 {v1::PHASE_HOLD, "hold"},
                                                                 {v1::PHASE_RELEASE, "release"},
                                                                 {v1::PHASE_RETRACT, "retract"}});

}  // namespace prehend::convert
