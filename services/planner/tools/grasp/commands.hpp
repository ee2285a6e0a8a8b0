#pragma once

#include "common/tool/program.hpp"

namespace prehend::planner {

/// Each adds its subcommand, which answers with the exit code.
void add_quality(tool::Program& program);

}  // namespace prehend::planner
