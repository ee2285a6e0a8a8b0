#pragma once

#include "common/tool/program.hpp"

namespace prehend::demonstration {

/// Each adds its subcommand, which answers with the exit code.
void add_train(tool::Program& program);
void add_evaluate(tool::Program& program);
void add_draw(tool::Program& program);
void add_show(tool::Program& program);

}  // namespace prehend::demonstration
