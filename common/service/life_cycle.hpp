#pragma once

#include <memory>

#include "common/service/arguments.hpp"
#include "common/service/shell.hpp"
#include "common/tool/output.hpp"

namespace prehend::service {

/// The life of a service's process, from its arguments to its exit code: joins the lab, makes the
/// service, runs until it is stopped. Whatever fails is said on one line.
///   S::create(Shell&) -> Expected<std::unique_ptr<S>>
template <class S>
int run(int argc, char** argv, const Shell::Options& options) {
  return tool::with_whole_output([&] {
    auto shell = Shell::create(argc, argv, options);
    if (!shell) return complain(shell.error());
    auto service = S::create(**shell);
    if (!service) return complain(service.error());
    const auto ended = (*shell)->run();
    return ended ? static_cast<int>(*ended) : complain(ended.error());
  });
}

}  // namespace prehend::service
