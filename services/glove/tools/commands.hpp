#pragma once

#include "common/tool/program.hpp"

namespace prehend::glove {

/// Each adds its subcommand, which answers with the exit code.
void add_devices(tool::Program& program);
void add_decode(tool::Program& program);
void add_emulate(tool::Program& program);
void add_calibrate(tool::Program& program);
void add_register(tool::Program& program);
void add_watch(tool::Program& program);
void add_filter_report(tool::Program& program);

}  // namespace prehend::glove
