#pragma once

#include "common/tool/program.hpp"

namespace prehend::planner {

/// Each adds its subcommand, which answers with the exit code.
void add_check(tool::Program& program);
void add_add(tool::Program& program);
void add_solve(tool::Program& program);
void add_reach(tool::Program& program);

}  // namespace prehend::planner
