#pragma once

#include "common/tool/program.hpp"

namespace prehend::robot {

/// Each adds its subcommand, which answers with the exit code.
void add_emulate(tool::Program& program);
void add_check(tool::Program& program);
void add_home(tool::Program& program);
void add_status(tool::Program& program);
void add_twin(tool::Program& program);

}  // namespace prehend::robot
