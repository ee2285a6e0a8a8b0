#include "services/recorder/core/dataset/episodes.hpp"

#include <algorithm>

namespace prehend::recorder::dataset {
namespace {

/// What was grasped in it, else what the last commands were for.
std::string object_of(const RecordingLog& log, Time begin, Time end) {
  std::string object;
  for (std::size_t i = 0; i < log.command_object.times.size(); ++i) {
    const Time time = log.command_object.times[i];
    if (begin <= time && time <= end && !log.command_object.values[i].empty())
      object = log.command_object.values[i];
  }
  for (const Judgement& judgement : log.judgements)
    if (begin <= judgement.time && judgement.time <= end) object = judgement.object;
  return object;
}

std::optional<bool> all_held(const RecordingLog& log, Time begin, Time end) {
  std::optional<bool> held;
  for (const Judgement& judgement : log.judgements)
    if (begin <= judgement.time && judgement.time <= end)
      held = held.value_or(true) && judgement.held;
  return held;
}

std::vector<Episode> of_attempts(const RecordingLog& log, const std::vector<Attempt>& attempts) {
  std::vector<Episode> episodes;
  for (const Attempt& attempt : attempts)
    episodes.push_back(
        {attempt.begin, attempt.end, attempt.task, object_of(log, attempt.begin, attempt.end),
         attempt.success ? attempt.success : all_held(log, attempt.begin, attempt.end)});
  return episodes;
}

std::vector<Episode> of_judgements(const RecordingLog& log) {
  std::vector<Episode> episodes;
  Time begin = log.command_dof.times.front();
  for (std::size_t i = 0; i < log.judgements.size(); ++i) {
    const Judgement& judgement = log.judgements[i];
    Time end = judgement.until.value_or(judgement.time + tail);
    // The other half of the time belongs to the next one.
    if (i + 1 < log.judgements.size())
      end = std::min(end, judgement.time + (log.judgements[i + 1].time - judgement.time) / 2);
    // Judged before anybody led the hand: what is transient local stands at the beginning.
    if (judgement.time <= log.command_dof.times.front()) continue;
    episodes.push_back({begin, end, "grasp " + judgement.object, judgement.object, judgement.held});
    begin = end;
  }
  return episodes;
}

}  // namespace

std::vector<Episode> find_episodes(const RecordingLog& log) {
  if (log.command_dof.empty()) return {};
  if (!log.runs.empty()) return of_attempts(log, log.runs);
  if (!log.shown.empty()) return of_attempts(log, log.shown);
  auto episodes = of_judgements(log);
  if (!episodes.empty()) return episodes;
  const Time begin = log.command_dof.times.front(), end = log.command_dof.times.back();
  const std::string object = object_of(log, begin, end);
  return {{begin, end, object.empty() ? "lead the hand" : "grasp " + object, object, std::nullopt}};
}

}  // namespace prehend::recorder::dataset
