#pragma once

#include "common/service/arguments.hpp"
#include "common/tool/program.hpp"

namespace prehend::robot {

struct VisitArguments {
  service::LabArguments lab;
  bool json = false;
};

/// Talks to the robot at robot.port without a service, lets it home if that is wanted, and says how
/// it is. Returns the exit code.
int visit(const VisitArguments& arguments, bool homes);

}  // namespace prehend::robot
