#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/base/to_terminal.hpp"
#include "services/glove/devices/device.hpp"
#include "services/glove/tools/commands.hpp"

namespace prehend::glove {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const DeviceKind& kind) {
  return {{"name", kind.name},
          {"help", kind.help},
          {"line", line_names.name(kind.line)},
          {"emulator", kind.emulate != nullptr},
          {"from_scene", kind.synthetic},
          {"hands", {"right", "left"}},
          {"tracker", kind.tracker.empty() ? Json(nullptr) : Json(kind.tracker)},
          {"keys", kind.keys}};
}

int show(bool json) {
  Json document{{"devices", Json::array()}};
  for (const DeviceKind& kind : device_kinds()) {
    document["devices"].push_back(to_json(kind));
    if (!json)
      to_terminal("{:<14} {:<7} {}{}\n", kind.name, line_names.name(kind.line), kind.help,
                  kind.emulate ? "; can be emulated" : "");
  }
  if (json) std::cout << document.dump() << '\n';
  return 0;
}

}  // namespace

void add_devices(tool::Program& program) {
  auto* command = program.app().add_subcommand("devices", "the devices that glove.device can name");
  const auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "one JSON document, for other programs");
  program.on(*command, [json] { return show(*json); });
}

}  // namespace prehend::glove
