#pragma once

#include <prehend/service/arguments.hpp>

/// The subcommands of `prehend` take their arguments as all programs do.
namespace prehend::cli {

using service::complain;
using service::exit_broken;
using service::exit_done;
using service::exit_no;
using service::exit_wrong_use;
using service::LabArguments;
using service::parse;

}  // namespace prehend::cli
