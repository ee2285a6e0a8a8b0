#pragma once

#include "common/tool/program.hpp"

namespace prehend::planner {

/// Subcommands of `prehend grasp` about planned grasps; see tool.hpp.
void add_plan(tool::Program& program);
void add_candidates(tool::Program& program);
void add_export(tool::Program& program);
void add_picture(tool::Program& program);
void add_table(tool::Program& program);
void add_taxonomy(tool::Program& program);
void add_classify(tool::Program& program);

}  // namespace prehend::planner
