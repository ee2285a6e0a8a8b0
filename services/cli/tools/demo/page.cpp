#include "services/cli/tools/demo/page.hpp"

#include "common/base/file_text.hpp"
#include "common/base/log.hpp"

namespace prehend::cli {

Expected<void> show_page(stage::Stage& stage, const std::vector<std::string>& sets) {
  if (auto started = stage.start_service("console", sets); !started) return started;
  // Where it is is the first that it says.
  std::string address;
  const auto said_where = [&] {
    const std::string said = read_file(stage.folder() / "console.log").value_or("");
    const std::size_t from = said.find("http"), to = said.find('\n', from);
    if (to != std::string::npos) address = said.substr(from, to - from);
    return !address.empty();
  };
  const auto late = [] { return Error{"did not come up", "console", ""}; };
  return stage.until("starting the console", said_where, late).map([&] {
    log::info("watch it at {}; Ctrl-C ends it", address);
  });
}

}  // namespace prehend::cli
