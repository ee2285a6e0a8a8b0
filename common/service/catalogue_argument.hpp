#pragma once

#include <filesystem>
#include <string>

#include "common/base/error.hpp"

namespace CLI {
class App;
}

namespace prehend::service {

/// Which catalogue of objects is meant, for every command that takes objects by their names:
/// --catalogue, else lab.catalogue of --config, of the environment, or of the configuration that
/// came with the programs.
struct CatalogueArgument {
  std::string file, config;

  void add_to(CLI::App& app);
  Expected<std::filesystem::path> path() const;
};

}  // namespace prehend::service
