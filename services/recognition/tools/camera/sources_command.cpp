#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/base/to_terminal.hpp"
#include "services/recognition/cameras/camera.hpp"
#include "services/recognition/tools/camera/commands.hpp"

namespace prehend::recognition {
namespace {

/// The table of cameras, for people and for programs that name none themselves.
int show_sources(bool json) {
  nlohmann::ordered_json document{{"sources", nlohmann::ordered_json::array()}};
  for (const CameraKind& kind : camera_kinds()) {
    document["sources"].push_back({{"name", kind.name},
                                   {"help", kind.help},
                                   {"line", camera_line_names.name(kind.line)},
                                   {"from_scene", kind.synthetic}});
    if (!json)
      to_terminal("{:<10} {:<7} {}\n", kind.name, camera_line_names.name(kind.line), kind.help);
  }
  if (json) std::cout << document.dump() << '\n';
  return exit_done;
}

}  // namespace

void add_sources(tool::Program& program) {
  auto* command =
      program.app().add_subcommand("sources", "The cameras that recognition.source can name.");
  const auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "one JSON document, for other programs");
  program.on(*command, [json] { return show_sources(*json); });
}

}  // namespace prehend::recognition
