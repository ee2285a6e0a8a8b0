#pragma once

#include "common/stage/stage.hpp"
#include "services/cli/service/outcome.hpp"
#include "services/cli/tools/demo/options.hpp"

namespace prehend::cli {

/// Gives one demonstration with the services as processes of their own, or watches a lab that runs,
/// until the first grasp has been judged. Ctrl-C ends it, and the services with it.
Expected<Outcome> demonstrate(const DemoOptions& options, const stage::Progress& progress);

}  // namespace prehend::cli
