#pragma once

#include <chrono>
#include <string>
#include <thread>

#include "common/base/log.hpp"
#include "services/glove/tools/frame_input.hpp"

namespace prehend::glove {

/// Leads a person through a Calibrator or Toucher: prompts, takes, hints, lets the last one be
/// shown again. `prompt(asked)` gives the words for what is asked, `praise(taken)` those for what
/// was taken. Ends when all was taken, when a recording ends, when the person gives up (q) or
/// `limit_s` has passed; false in the last two cases.
template <class Guide, class Prompt, class Praise>
bool ask(FrameInput& input, Guide& guide, double limit_s, const Prompt& prompt,
         const Praise& praise) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  Clock::time_point since = begin;
  std::string reason;
  bool hinted = false;
  const auto say = [&] {
    if (guide.asked()) log::info("{}", prompt(*guide.asked()));
  };
  if (input.live()) log::info("keys, each with Enter: r shows the last one again, q gives up");
  say();
  while (guide.asked()) {
    for (const Frame& frame : input.poll())
      if (const auto taken = guide.see(frame)) {
        log::info("   {}", praise(*taken));
        say();
      }
    if (!input.live()) return true;
    const char key = entered_key();
    if (key == 'q') return false;
    if (key == 'r' && guide.redo()) say();
    if (guide.waiting_for() != reason) {
      reason = guide.waiting_for();
      since = Clock::now();
      hinted = false;
    } else if (!hinted && Clock::now() - since > std::chrono::seconds(3)) {
      log::info("   {}", reason);
      hinted = true;
    }
    if (std::chrono::duration<double>(Clock::now() - begin).count() > limit_s) {
      log::error("gave up after {:.0f} s: {}", limit_s, guide.waiting_for());
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return true;
}

}  // namespace prehend::glove
