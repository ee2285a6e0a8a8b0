#include "common/stage/conductor.hpp"

#include <algorithm>

namespace prehend::stage {

Expected<Conductor> Conductor::create(dds::Participant& participant,
                                      const std::vector<std::string>& services) {
  auto clock = participant.writer(dds::lab_clock);
  if (!clock) return tl::unexpected(clock.error());
  auto progress = participant.reader(dds::lab_progress);
  if (!progress) return tl::unexpected(progress.error());
  return Conductor(std::move(*clock), std::move(*progress), services);
}

Conductor::Conductor(dds::Writer<v1::LabClock> clock, dds::Reader<v1::LabProgress> progress,
                     const std::vector<std::string>& services)
    : clock_(std::move(clock)),
      progress_(std::move(progress)),
      services_(services.begin(), services.end()) {}

void Conductor::published(std::string_view topic, std::uint64_t count) {
  own_[std::string(topic)] += count;
}

std::map<std::string, std::uint64_t> Conductor::totals() const {
  std::map<std::string, std::uint64_t> sum = own_;
  for (const auto& [service, counts] : by_service_)
    for (const auto& [topic, count] : counts) sum[topic] += count;
  return sum;
}

Expected<void> Conductor::step(Time now, std::chrono::milliseconds patience,
                               const std::function<std::optional<Error>()>& dead) {
  v1::LabClock message;
  message.cycle(++cycle_);
  message.stamp_ns(to_ns(now));
  for (const auto& [topic, count] : totals()) {
    v1::TopicCount entry;
    entry.topic(topic.c_str());
    entry.count(count);
    message.published().push_back(entry);
  }
  if (!clock_.write(message)) return fail("the clock cannot be published", "lab/clock");

  std::set<std::string> missing = services_;
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
      const std::string service = sample.data.service().c_str();
      auto& counts = by_service_[service];
      for (const auto& entry : sample.data.published())
        counts[entry.topic().c_str()] = entry.count();
      missing.erase(service);
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
