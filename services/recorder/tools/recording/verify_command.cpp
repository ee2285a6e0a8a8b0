#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/base/to_terminal.hpp"
#include "services/recorder/tools/recording/commands.hpp"
#include "services/recorder/tools/recording/verify.hpp"

namespace prehend::recorder {
namespace {

struct VerifyArguments {
  std::string file;
  bool json = false;
};

int run(const VerifyArguments& arguments) {
  const auto findings = verify(arguments.file);
  if (!findings) return complain_of(arguments.file, findings.error());
  if (arguments.json) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Error& finding : *findings)
      list.push_back({{"where", finding.where}, {"what", finding.what}});
    std::cout << nlohmann::ordered_json{{"sound", findings->empty()}, {"findings", list}}.dump(
                     -1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
              << '\n';
  } else {
    for (const Error& finding : *findings) to_terminal("{}\n", finding.message());
    if (findings->empty()) to_terminal("{}: sound\n", arguments.file);
  }
  return findings->empty() ? exit_done : exit_no;
}

}  // namespace

void add_verify(tool::Program& program) {
  auto* command =
      program.app().add_subcommand("verify", "is every byte of a recording as it should be");
  const auto arguments = std::make_shared<VerifyArguments>();
  command->add_option("FILE", arguments->file, "recording")->required();
  command->add_flag("--json", arguments->json, "one JSON document");
  program.on(*command, [arguments] { return run(*arguments); });
}

}  // namespace prehend::recorder
