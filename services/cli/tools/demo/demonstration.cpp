#include "services/cli/tools/demo/demonstration.hpp"

#include <fmt/format.h>

#include <chrono>

#include "common/model/scene.hpp"
#include "services/cli/tools/demo/onlooker.hpp"
#include "services/cli/tools/demo/stage.hpp"

namespace prehend::cli {
namespace {

using Clock = std::chrono::steady_clock;

/// The lab that runs.
Trouble attach(const DemoOptions& options, Onlooker& onlooker) {
  const auto config = options.lab.load();
  if (!config) return wrong(config.error());
  std::optional<model::Scene> truth;
  if (const std::filesystem::path file = config->path("lab.scene"); !file.empty()) {
    const auto catalogue = model::Catalogue::load(config->path("lab.catalogue"));
    if (!catalogue) return broken(catalogue.error());
    auto scene = model::load_scene(file, *catalogue);
    if (!scene) return broken(scene.error());
    truth = std::move(*scene);
  }
  return onlooker.listen(*config, truth);
}

/// Why it ended: a grasp was judged (nothing), or what did not come.
using Ended = tl::expected<std::string, Failure>;

/// Until the first grasp is judged and everyone has told the figures; a recording is played to its
/// end.
Ended watch(const DemoOptions& options, Onlooker& onlooker, Stage& stage) {
  const Observer& seen = onlooker.seen();
  const bool playing = stage.plays_recording() && !options.attach;
  std::uint64_t frames = 0;
  auto news = Clock::now();
  std::optional<Clock::time_point> judged;
  while (true) {
    if (const auto trouble = onlooker.step(judged             ? "judged"
                                           : seen.commanded() ? "reaching"
                                                              : "waiting"))
      return tl::unexpected(*trouble);
    const auto now = Clock::now();
    if (seen.frames() != frames) {
      frames = seen.frames();
      news = now;
    }
    if (!judged && seen.judged()) judged = now;
    // The status comes once a second; the judge needs a moment after the last frame.
    const bool silent = now - news > std::chrono::milliseconds(2500);
    const bool over = !playing || (frames > 0 && (silent || stage.glove_has_ended()));
    const bool settled =
        judged && (seen.latency_is_in() || now - *judged > std::chrono::milliseconds(2500));
    if (settled && over) return "";
    if (playing && frames > 0 && silent && !judged)
      return "the recording ended before a grasp was closed";
    if (onlooker.is_late())
      return fmt::format("no {} within {:.0f} s", frames == 0 ? "glove frame" : "grasp was closed",
                         options.timeout);
  }
}

}  // namespace

tl::expected<Outcome, Failure> demonstrate(const DemoOptions& options, const Progress& progress) {
  Onlooker onlooker(progress, options.timeout);
  Stage stage(options, onlooker);
  if (const auto trouble = options.attach ? attach(options, onlooker) : stage.put_up())
    return tl::unexpected(*trouble);
  const auto glove_start = Clock::now();
  const Ended reason = watch(options, onlooker, stage);
  if (!reason) return tl::unexpected(reason.error());
  Outcome outcome = onlooker.seen().outcome();
  outcome.seconds = to_seconds(Clock::now() - glove_start);
  if (!outcome.judged) outcome.grasp.reason = *reason;
  if (outcome.device.empty()) outcome.device = stage.glove();
  if (outcome.hand.empty()) outcome.hand = stage.hand();
  if (options.watch) {
    options.on_outcome(outcome);
    while (!onlooker.step("watching")) {
    }
  }
  return outcome;
}

}  // namespace prehend::cli
