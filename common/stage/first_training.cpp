#include "common/stage/first_training.hpp"

#include "common/base/paths.hpp"
#include "common/stage/process.hpp"

namespace prehend::stage {

Expected<void> train_if_needed(const std::string& hand, const std::function<bool()>& stopped) {
  const std::string hint = "prehend train --hand " + hand;
  auto process =
      Process::start({{program_directory() / "prehend-train", "--hand", hand, "--if-needed"}});
  if (!process) return tl::unexpected(process.error());
  std::optional<Process::Exit> ended;
  while (!(ended = process->wait(std::chrono::milliseconds(100))))
    if (stopped()) return fail("", "", "", exit_done);
  if (ended->code != exit_done) return fail("could not be trained", hand, hint);
  return {};
}

}  // namespace prehend::stage
