#include "services/cli/tools/alive_command.hpp"

#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/service/pulse.hpp"
#include "services/cli/tools/arguments.hpp"

namespace prehend::cli {

int alive_command(const std::vector<std::string>& arguments) {
  CLI::App app{
      "Asks a service on this host, or in this container, whether it is alive. It answers by\n"
      "itself, over a local socket: neither DDS nor keys are used, so that a network or a "
      "discovery\n"
      "server that is gone does not make it seem dead. Exit code 1: it does not answer.",
      "prehend alive"};
  LabArguments lab;
  std::string name;
  double timeout = 4;
  bool json = false;
  lab.add_to(app);
  app.add_option("NAME", name, "of the service: glove, mapping, ...")->required();
  app.add_option("--timeout", timeout, "s to wait for the answer")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 3600.0));
  app.add_flag("--json", json, "one JSON document on standard output");
  if (const auto code = parse(app, arguments)) return *code;

  const auto config = lab.load();
  if (!config) return complain(config.error(), exit_wrong_use);
  const auto answered = service::ask_pulse(service::pulse_name(*config, name), seconds(timeout));
  if (json)
    std::cout << nlohmann::ordered_json{{"name", name},
                                        {"alive", answered.has_value()},
                                        {"reason", answered ? "" : answered.error().message()}}
                     .dump()
              << "\n";
  if (answered) return exit_done;
  return complain(answered.error(), exit_no);
}

}  // namespace prehend::cli
