#pragma once

#include <nlohmann/json.hpp>

#include "tests/integration/rig.hpp"

namespace prehend::integration {

/// `prehend demo` as a user runs it, with all services as processes.
class Demo : public Rig {
 protected:
  /// The demonstration has 45 s, and some more to start and stop processes.
  Answer demo(Strings arguments) {
    arguments.insert(arguments.begin(), {"demo", "--json", "--domain", std::to_string(domain_)});
    return run("prehend", arguments, 55);
  }
};

}  // namespace prehend::integration
