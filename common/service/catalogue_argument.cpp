#include "common/service/catalogue_argument.hpp"

#include <CLI/CLI.hpp>

#include "common/service/arguments.hpp"

namespace prehend::service {

void CatalogueArgument::add_to(CLI::App& app) {
  app.add_option("--catalogue", file, "objects by their names; else lab.catalogue");
  app.add_option("--config", config, "the lab's configuration file, which names the catalogue");
}

Expected<std::filesystem::path> CatalogueArgument::path() const {
  if (!file.empty()) return std::filesystem::path(file);
  LabArguments lab;
  lab.config = config;
  return lab.load().map([](const Config& read) { return read.path("lab.catalogue"); });
}

}  // namespace prehend::service
