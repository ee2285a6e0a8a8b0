#pragma once

#include <prehend/base/error.hpp>
#include <prehend/service/shell.hpp>

namespace prehend::mapping {

/// Connects the mapping to the lab's topics and runs until it is stopped. Fails when hand or model
/// cannot be used; otherwise returns the shell's exit code.
Expected<int> run(service::Shell& shell);

}  // namespace prehend::mapping
