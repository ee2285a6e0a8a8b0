#pragma once

#include "common/tool/program.hpp"

namespace prehend::recognition {

/// Each adds its subcommand of `prehend camera`, which answers with the exit code.
void add_calibrate(tool::Program& program);
void add_sources(tool::Program& program);

}  // namespace prehend::recognition
