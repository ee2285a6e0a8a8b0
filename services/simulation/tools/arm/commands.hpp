#pragma once

#include "common/model/arm_model.hpp"
#include "common/tool/program.hpp"

namespace prehend::simulation {

/// Each adds its subcommand, which answers with the exit code.
void add_check(tool::Program& program);
void add_add(tool::Program& program);
void add_solve(tool::Program& program);
void add_reach(tool::Program& program);

/// The arm of this name, or in this folder. An unknown one is wrong use.
Expected<model::ArmModel> load_arm(const std::string& name);

}  // namespace prehend::simulation
