#pragma once

#include "common/service/arguments.hpp"

/// The subcommands of `prehend` take their arguments as all programs do.
namespace prehend::cli {

using service::complain;
using service::LabArguments;
using service::parse;

}  // namespace prehend::cli
