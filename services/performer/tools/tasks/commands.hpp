#pragma once

#include "common/tool/program.hpp"

namespace prehend::performer {

/// Each adds its subcommand, which answers with the exit code.
void add_list(tool::Program& program);
void add_show(tool::Program& program);
void add_edit(tool::Program& program);
void add_check(tool::Program& program);
void add_run(tool::Program& program);
void add_order(tool::Program& program);
void add_demo(tool::Program& program);
void add_evaluate(tool::Program& program);

}  // namespace prehend::performer
