#pragma once

#include "common/base/error.hpp"
#include "common/tool/program.hpp"

namespace prehend::recognition {

/// Each adds its subcommand, which answers with the exit code.
void add_render(tool::Program& program);
void add_train(tool::Program& program);
void add_add(tool::Program& program);
void add_detect(tool::Program& program);
void add_evaluate(tool::Program& program);
void add_scenes(tool::Program& program);

/// Says what is missing or broken, on one line, and returns the exit code.
int broken(const Error& error);

}  // namespace prehend::recognition
