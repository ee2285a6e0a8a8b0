// A damaged recording as `prehend recording export` meets it: read, cut into episodes, made rows
// of. Nothing may crash or take more memory than its rows need; every number of a row is finite,
// and all of an episode's tables have its rows. Seeds: deploy/samples, without compression and
// CRCs, so that what is changed is messages.
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "services/recorder/core/dataset/rows.hpp"
#include "services/recorder/tools/dataset/read_log.hpp"
#include "services/recorder/tools/recording/copy.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"
#include "tests/support/paths/paths.hpp"

using namespace prehend;

namespace {

std::string path() {
  return (std::filesystem::temp_directory_path() /
          ("prehend-training-rows-" + std::to_string(::getpid()) + ".mcap"))
      .string();
}

/// The last two seconds of a sample: its grasp is in them.
std::string plain(const std::string& sample) {
  std::vector<recording::mcap::Reader> sources;
  sources.push_back(
      recording::mcap::Reader::open(test::in_sources("deploy/samples/") + sample).value());
  const std::uint64_t end = sources.front().statistics().message_end_time;
  recorder::CopyOptions options;
  options.selection.start = end - 2'000'000'000;
  options.selection.wanted = [](const recording::mcap::Channel& channel) {
    return channel.topic != "camera/image" && channel.topic != "service/status";
  };
  options.writer.compression = recording::mcap::Compression::none;
  options.writer.crcs = false;
  recorder::copy(sources, path(), options).value();
  const std::string bytes = fuzz::read_file(path());
  std::filesystem::remove(path());
  return bytes;
}

void check(const recorder::dataset::Rows& rows) {
  const auto good = [&](const recorder::dataset::Table& table) {
    fuzz::require(table.rows() == rows.count, "a table has other rows");
    fuzz::require(table.allFinite(), "a number is not finite");
  };
  good(rows.state.values);
  good(rows.action.values);
  good(rows.rate);
  if (rows.effort.cols() > 0) good(rows.effort);
  for (const auto& feature : rows.others) {
    good(feature.values);
    fuzz::require(feature.values.cols() == static_cast<Eigen::Index>(feature.columns.size()),
                  "a column has no name");
  }
}

bool target(const std::string& bytes) {
  std::ofstream(path(), std::ios::binary) << bytes;
  const auto read = recorder::dataset::read_log(path(), "");
  std::filesystem::remove(path());
  if (!read) {
    fuzz::require(!read.error().what.empty(), "refused without a reason");
    return false;
  }
  bool made = false;
  for (const auto& episode : recorder::dataset::find_episodes(read->log)) {
    const auto rows = recorder::dataset::make_rows(read->log, episode, {.rate = 2});
    if (rows) check(*rows);
    made = made || rows;
  }
  return made;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> seeds{plain("direct-grasp.mcap"), plain("intelligent-grasp.mcap")};
  return fuzz::run({seeds, fuzz::mutate_bytes, target, 10'000}, argc, argv);
}
