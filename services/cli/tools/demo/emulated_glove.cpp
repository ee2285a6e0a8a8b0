#include "services/cli/tools/demo/emulated_glove.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include "services/cli/tools/demo/free_address.hpp"

namespace prehend::cli {
namespace {

bool is_serial(const GloveRow& row) {
  return row.line == "serial";
}

std::string free_port(const GloveRow& row, const std::string& whose, const stage::Stage& stage) {
  std::string word = whose.substr(0, whose.find(' '));
  if (!word.empty()) word += "_";
  if (is_serial(row)) return (stage.folder() / (word + "glove_port")).string();
  return row.line == "nodes" ? fmt::format("demo_{}{}/hand_joints", word, ::getpid())
                             : free_address();
}

Expected<void> plug_in(const EmulatedGlove& glove, stage::Stage& stage) {
  const std::string name = glove.whose + "emulated " + glove.row.name;
  std::vector<std::string> arguments{"emulate", "--kind", glove.row.name, "--scene",
                                     glove.scene_file.string()};
  std::vector<std::string> sets = glove.sets;
  if (is_serial(glove.row))
    arguments.insert(arguments.end(), {"--link", glove.port});
  else
    sets.push_back("glove.port=" + glove.port);
  auto started = stage.start(name, "prehend-glove-tool", arguments, sets);
  return started && is_serial(glove.row) ? await_port(glove.port, name, stage) : started;
}

}  // namespace

Expected<void> await_port(const std::filesystem::path& port, const std::string& process,
                          stage::Stage& stage) {
  return stage.until_there("starting the " + process, port, [&] {
    return Error{"did not open its port", process, ""};
  });
}

Expected<std::vector<std::string>> emulate(const EmulatedGlove& wanted,
                                           const std::vector<GloveRow>& rows, stage::Stage& stage) {
  EmulatedGlove glove = wanted;
  if (glove.port.empty()) glove.port = free_port(glove.row, glove.whose, stage);
  if (auto there = plug_in(glove, stage); !there) return tl::unexpected(there.error());
  std::vector<std::string> told{"glove.port=" + glove.port};
  if (glove.row.tracker.empty() || !wanted.port.empty()) return told;

  // It measures only joints: a tracker on its back says where the hand is.
  auto tracker = find_row(rows, glove.row.tracker, glove.row.name);
  if (!tracker) return tl::unexpected(tracker.error());
  EmulatedGlove back = wanted;
  back.row = *tracker;
  back.port = glove.port + "_wrist";
  back.sets.push_back("glove.sites=[\"back_of_hand\"]");
  if (auto there = plug_in(back, stage); !there) return tl::unexpected(there.error());
  told.push_back("glove.wrist_port=" + back.port);
  return told;
}

}  // namespace prehend::cli
