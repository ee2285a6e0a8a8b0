#include "common/service/arguments.hpp"

#include <CLI/CLI.hpp>

#include "common/base/log_format.hpp"
#include "common/base/paths.hpp"

namespace prehend::service {

void LabArguments::add_to(CLI::App& app) {
  app.add_option("--config", config, "the lab's configuration file");
  app.add_option("--set", sets, "override a key: table.key=value; may be repeated")
      ->type_size(1)
      ->allow_extra_args(false);
  app.add_option("--domain", domain, "DDS domain")->check(CLI::Range(0, 232));
}

std::string LabArguments::file() const {
  return config.empty() ? (share_directory() / "lab.toml").string()
                        : std::filesystem::absolute(config).string();
}

std::vector<std::string> LabArguments::overrides() const {
  std::vector<std::string> result = sets;
  if (domain) result.push_back("lab.domain=" + std::to_string(*domain));
  return result;
}

Expected<Config> LabArguments::load() const {
  auto config = Config::load(file(), overrides());
  if (config) log::set_rig(config->text("lab.rig"));
  return config;
}

std::vector<std::string> LabArguments::for_service() const {
  std::vector<std::string> arguments{"--config", file()};
  for (const std::string& set : overrides()) arguments.insert(arguments.end(), {"--set", set});
  return arguments;
}

}  // namespace prehend::service
