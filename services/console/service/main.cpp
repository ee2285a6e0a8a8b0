#include <algorithm>
#include <string>
#include <vector>

#include "common/service/life_cycle.hpp"
#include "common/tool/output.hpp"
#include "services/console/service/recording.hpp"
#include "services/console/service/service.hpp"

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  const bool recorded = std::any_of(arguments.begin(), arguments.end(), [](const auto& argument) {
    return argument == "--recording" || argument.starts_with("--recording=");
  });
  if (recorded)
    return prehend::tool::with_whole_output(
        [&] { return prehend::console::show_recording(arguments); });
  return prehend::service::run<prehend::console::Service>(
      argc, argv,
      {.name = "console",
       .description = "Shows the lab in a browser, and to viewers of Foxglove. With\n"
                      "--recording FILE it needs no lab."});
}
