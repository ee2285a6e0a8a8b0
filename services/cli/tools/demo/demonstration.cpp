#include "services/cli/tools/demo/demonstration.hpp"

#include <fmt/format.h>

#include <chrono>

#include "services/cli/tools/demo/chosen_hand.hpp"
#include "services/cli/tools/demo/grasp_play.hpp"

namespace prehend::cli {
namespace {

using Clock = std::chrono::steady_clock;

/// Until the first grasp is judged and everyone has told the figures; a recording is played to its
/// end. Why it ended: a grasp was judged (empty), or what did not come.
Expected<std::string> watch(const DemoOptions& options, stage::Stage& stage, GraspPlay& play) {
  const Observer& seen = play.seen();
  const bool playing = play.plays_recording() && !options.attach;
  std::uint64_t frames = 0;
  auto news = Clock::now();
  std::optional<Clock::time_point> judged;
  while (true) {
    if (const auto looked = stage.look(judged             ? "judged"
                                       : seen.commanded() ? "reaching"
                                                          : "waiting");
        !looked)
      return tl::unexpected(looked.error());
    const auto now = Clock::now();
    if (seen.frames() != frames) {
      frames = seen.frames();
      news = now;
    }
    if (!judged && seen.judged()) judged = now;
    // The status comes once a second; the judge needs a moment after the last frame.
    const bool silent = now - news > std::chrono::milliseconds(2500);
    const bool over = !playing || (frames > 0 && (silent || stage.has_ended("glove")));
    const bool settled =
        judged && (seen.latency_is_in() || now - *judged > std::chrono::milliseconds(2500));
    if (settled && over) return "";
    if (playing && frames > 0 && silent && !judged)
      return "the recording ended before a grasp was closed";
    if (stage.is_late())
      return fmt::format("no {} within {:.0f} s", frames == 0 ? "glove frame" : "grasp was closed",
                         options.timeout);
  }
}

}  // namespace

Expected<Outcome> demonstrate(const DemoOptions& options, const stage::Progress& progress) {
  if (const auto trained = train_hand(options); !trained) return tl::unexpected(trained.error());
  auto stage = stage::Stage::create({options.lab, options.timeout, options.keep, progress});
  if (!stage) return tl::unexpected(stage.error());
  GraspPlay play(options, *stage);
  if (const auto ready = options.attach ? play.attach() : play.put_up(); !ready)
    return tl::unexpected(ready.error());
  const auto glove_start = Clock::now();
  const auto reason = watch(options, *stage, play);
  if (!reason) return tl::unexpected(reason.error());
  Outcome outcome = play.seen().outcome();
  outcome.seconds = to_seconds(Clock::now() - glove_start);
  if (!outcome.judged) outcome.grasp.reason = *reason;
  if (outcome.device.empty()) outcome.device = play.glove();
  if (outcome.hand.empty()) outcome.hand = play.hand();
  if (options.watch) {
    options.on_outcome(outcome);
    while (stage->look("watching")) {
    }
  }
  return outcome;
}

}  // namespace prehend::cli
