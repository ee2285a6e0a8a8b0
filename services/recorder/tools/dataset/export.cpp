#include "services/recorder/tools/dataset/export.hpp"

#include <fmt/format.h>

#include "common/base/log.hpp"
#include "common/base/progress.hpp"
#include "common/base/to_terminal.hpp"
#include "common/tool/program.hpp"
#include "services/recorder/tools/dataset/gather.hpp"
#include "services/recorder/tools/dataset/layouts.hpp"

namespace prehend::recorder::dataset {
namespace {

/// A place beside the output, which was not there; what is left of it when this ends is gone.
class Unfinished {
 public:
  explicit Unfinished(std::filesystem::path to) : to_(std::move(to)), path_(of(to_)) {}
  static std::filesystem::path of(std::filesystem::path to) { return to += ".unfinished"; }
  ~Unfinished() { remove(); }
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;

  const std::filesystem::path& path() const { return path_; }
  Expected<void> finish() {
    std::error_code problem;
    std::filesystem::rename(path_, to_, problem);
    if (problem) return fail(problem.message(), to_.string());
    return {};
  }

 private:
  void remove() const {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  std::filesystem::path to_, path_;
};

Expected<void> write(const Dataset& dataset, const DatasetOptions& options) {
  const std::filesystem::path to =
      std::filesystem::path(options.output + "/.").parent_path().lexically_normal();
  std::error_code problem;
  if (!to.parent_path().empty()) std::filesystem::create_directories(to.parent_path(), problem);
  if (problem) return fail(problem.message(), to.parent_path().string());
  if (std::filesystem::exists(Unfinished::of(to), problem))
    return fail("is there already", Unfinished::of(to).string(),
                "of an export that was killed? remove it", exit_wrong_use);
  Unfinished unfinished(to);
  Progress progress("writing episodes");
  std::size_t done = 0;
  const Written written = [&] { progress.show(++done, dataset.episodes.size()); };
  const auto writer = options.format == "robomimic" ? write_robomimic
                      : options.format == "aloha"   ? write_aloha
                      : options.format == "lerobot" ? write_lerobot
                                                    : write_lerobot_v21;
  if (auto result = writer(dataset, unfinished.path(), written); !result) return result;
  return unfinished.finish();
}

void tell(const Gathered& gathered, const DatasetOptions& options) {
  std::size_t held = 0, dropped = 0;
  Eigen::Index rows = 0;
  for (const RecordedEpisode& each : gathered.dataset.episodes) {
    rows += each.rows.count;
    if (each.episode.success) ++(*each.episode.success ? held : dropped);
  }
  const std::size_t all = gathered.dataset.episodes.size();
  to_terminal("{}: {} episode{} ({} succeeded, {} failed, {} not judged), {} rows at {} Hz\n",
              options.output, all, all == 1 ? "" : "s", held, dropped, all - held - dropped, rows,
              options.rate);
  if (!gathered.left_out.empty())
    to_terminal("left out, since not every episode has it: {}\n",
                fmt::join(gathered.left_out, ", "));
}

}  // namespace

int write_dataset(const DatasetOptions& options) {
  if (auto possible = check(options); !possible) return tool::complain(possible.error());
  std::error_code problem;
  if (std::filesystem::exists(options.output, problem))
    return tool::complain({"is there already", options.output,
                           "remove it, or choose another place with -o", exit_wrong_use});
  auto gathered = gather(options);
  if (!gathered) return tool::complain(gathered.error());
  for (const Error& error : gathered->passed_by) log::write_warning(error.message());
  if (auto done = write(gathered->dataset, options); !done) return tool::complain(done.error());
  tell(*gathered, options);
  return gathered->passed_by.empty() ? exit_done : exit_no;
}

}  // namespace prehend::recorder::dataset
