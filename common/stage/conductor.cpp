#include "common/stage/conductor.hpp"

#include <algorithm>

namespace prehend::stage {

Expected<Conductor> Conductor::create(dds::Participant& participant,
                                      const std::vector<std::string>& services) {
  auto clock = participant.writer(dds::lab_clock);
  if (!clock) return tl::unexpected(clock.error());
  auto progress = participant.reader(dds::lab_progress);
  if (!progress) return tl::unexpected(progress.error());
  return Conductor(std::move(*clock), std::move(*progress), participant.identity(), services);
}

Conductor::Conductor(dds::Writer<v2::LabClock> clock, dds::Reader<v1::LabProgress> progress,
                     dds::GuidPrefix self, const std::vector<std::string>& services)
    : clock_(std::move(clock)),
      progress_(std::move(progress)),
      self_(self),
      services_(services.begin(), services.end()) {}

void Conductor::published(std::string_view topic, std::uint64_t count) {
  published_[self_][std::string(topic)] += count;
}

std::map<std::string, std::uint64_t> Conductor::totals() const {
  Counts sum;
  for (const auto& [participant, counts] : published_)
    for (const auto& [topic, count] : counts) sum[topic] += count;
  return sum;
}

Expected<void> Conductor::step(Time now, std::chrono::milliseconds patience,
                               const std::function<std::optional<Error>()>& dead) {
  v2::LabClock message;
  message.cycle(++cycle_);
  message.stamp_ns(to_ns(now));
  for (const auto& [participant, counts] : published_)
    for (const auto& [topic, count] : counts) {
      v2::WriterCount entry;
      entry.topic(topic.c_str());
      entry.participant(participant);
      entry.count(count);
      message.published().push_back(entry);
    }
  if (!clock_.write(message)) return fail("the clock cannot be published", "lab/clock");

  std::multiset<std::string> missing = services_;
  std::set<dds::GuidPrefix> answered;
  const auto give_up = std::chrono::steady_clock::now() + patience;
  while (!missing.empty()) {
    const auto left = give_up - std::chrono::steady_clock::now();
    if (left.count() <= 0)
      return fail("gave no answer in cycle " + std::to_string(cycle_), *missing.begin(),
                  "is it running, in lockstep, in this rig?");
    const Duration wait = std::min<Duration>(left, std::chrono::milliseconds(200));
    const bool came =
        progress_.raw().wait_for_unread_message({0, static_cast<uint32_t>(wait.count())});
    if (!came && dead)
      if (const auto error = dead()) return tl::unexpected(*error);
    for (const auto& sample : progress_.take()) {
      if (sample.info.gone || sample.data.cycle() != cycle_) continue;
      if (!answered.insert(sample.info.participant).second) continue;
      Counts& counts = published_[sample.info.participant];
      for (const auto& entry : sample.data.published())
        counts[entry.topic().c_str()] = entry.count();
      if (const auto one = missing.find(sample.data.service().c_str()); one != missing.end())
        missing.erase(one);
    }
  }
  return {};
}

Expected<void> Conductor::settle(Time now, std::chrono::milliseconds patience) {
  while (true) {
    const auto before = totals();
    if (const auto done = step(now, patience); !done) return done;
    if (totals() == before) return {};
  }
}

}  // namespace prehend::stage
