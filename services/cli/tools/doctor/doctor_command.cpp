#include "services/cli/tools/doctor/doctor_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/base/printable.hpp"
#include "common/service/arguments.hpp"
#include "services/cli/tools/doctor/machine.hpp"
#include "services/cli/tools/doctor/neighbours.hpp"
#include "services/cli/tools/doctor/wire.hpp"

namespace prehend::cli {

using namespace service;

int doctor_command(const std::vector<std::string>& arguments) {
  CLI::App app{
      "What is wrong with this machine's set-up, and the mend. Exit code 0: nothing, 1: something.",
      "prehend doctor"};
  LabArguments lab;
  bool json = false;
  double listen = 3;
  lab.add_to(app);
  app.add_option("--listen", listen, "s to listen to the others")->check(CLI::Range(0.5, 600.0));
  app.add_flag("--json", json, "one JSON document on standard output");
  if (const auto code = parse(app, arguments)) return *code;
  const auto config = lab.load();
  if (!config) return complain(config.error(), exit_wrong_use);

  const Time now = std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
  // The environment first: whoever joins the lab takes charge of it.
  Findings findings{check_environment(),    check_interface(*config),
                    check_profile(*config), check_keys(*config, now),
                    check_consent(*config), check_stale_memory(),
                    check_ipc_namespaces(), check_users(),
                    check_programs(),       check_devices(*config)};
  const std::string network = config->text("lab.network");
  if (network == "laptop" || network == "lan") findings.push_back(check_multicast(*config));
  if (network == "wan") findings.push_back(check_sites(*config));
  auto neighbours = check_neighbours(*config, seconds(listen));
  if (neighbours)
    std::move(neighbours->begin(), neighbours->end(), std::back_inserter(findings));
  else
    findings.push_back({"joining the lab", false, neighbours.error().message(),
                        "mend what stands above, then ask again"});

  auto checks = nlohmann::ordered_json::array();
  for (const Check& finding : findings) {
    if (json) {
      checks.push_back({{"name", finding.name},
                        {"ok", finding.ok},
                        {"detail", finding.detail},
                        {"mend", finding.hint}});
      continue;
    }
    std::cout << fmt::format("{:<7}{:<22}{}\n", finding.ok ? "ok" : "WRONG", finding.name,
                             printable(finding.detail));
    if (!finding.ok) std::cout << fmt::format("{:<29}mend: {}\n", "", printable(finding.hint));
  }
  if (json)
    std::cout << nlohmann::ordered_json{{"checks", checks}}.dump(
                     -1, ' ', false, nlohmann::json::error_handler_t::replace)
              << "\n";
  return std::all_of(findings.begin(), findings.end(), [](const Check& one) { return one.ok; })
             ? exit_done
             : exit_no;
}

}  // namespace prehend::cli
