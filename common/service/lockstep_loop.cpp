#include "common/service/lockstep_loop.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/log.hpp"
#include "common/dds/topics.hpp"

namespace prehend::service {
namespace {

/// How many samples of the topic the clock has counted of each writer.
std::map<dds::GuidPrefix, std::uint64_t> counted(const v2::LabClock& cycle,
                                                 std::string_view topic) {
  std::map<dds::GuidPrefix, std::uint64_t> counts;
  for (const auto& count : cycle.published())
    if (topic == std::string_view(count.topic().c_str()))
      counts[count.participant()] = count.count();
  return counts;
}

bool all_has_come(const v2::LabClock& cycle, const Inbox& inbox) {
  for (const auto& input : inbox.inputs())
    for (const auto& [writer, count] : counted(cycle, input->topic))
      if (input->received_from(writer) < count) return false;
  return true;
}

}  // namespace

LockstepLoop::LockstepLoop(dds::Writer<v1::LabProgress> writer, std::string service)
    : writer_(std::move(writer)), service_(std::move(service)) {}

Expected<LockstepLoop> LockstepLoop::create(dds::Participant& participant,
                                            const std::string& service) {
  auto writer = participant.writer(dds::lab_progress);
  if (!writer) return tl::unexpected(writer.error());
  return LockstepLoop(std::move(*writer), service);
}

bool LockstepLoop::run_cycle(Inbox& inbox, const std::function<void(Time)>& tick,
                             const Published& published) {
  if (cycles_.empty() || !all_has_come(cycles_.front(), inbox)) return false;
  const v2::LabClock& cycle = cycles_.front();
  now_ = from_ns(cycle.stamp_ns());
  // Of each writer only as many as the clock has counted: later ones belong to later cycles.
  std::vector<Arrival> due;
  std::uint32_t waiting = 0;
  for (const auto& input : inbox.inputs()) {
    std::vector<Arrival> taken, kept;
    auto counts = counted(cycle, input->topic);
    for (Arrival& arrival : input->waiting) {
      const bool is_due =
          arrival.index < counts[arrival.writer] && arrival.stamp_ns <= cycle.stamp_ns();
      (is_due ? taken : kept).push_back(std::move(arrival));
    }
    input->sort(taken);
    std::ranges::move(taken, std::back_inserter(due));
    waiting += static_cast<std::uint32_t>(kept.size());
    input->waiting = std::move(kept);
  }
  deliver(due);
  if (tick) tick(now_);
  answer(cycle, waiting, published);
  cycles_.pop_front();
  return true;
}

void LockstepLoop::answer(const v2::LabClock& cycle, std::uint32_t waiting,
                          const Published& published) {
  v1::LabProgress progress;
  progress.service(service_.c_str());
  progress.cycle(cycle.cycle());
  progress.stamp_ns(cycle.stamp_ns());
  progress.waiting(waiting);
  for (const auto& [topic, count] : published) {
    v1::TopicCount entry;
    entry.topic(topic.c_str());
    entry.count(count);
    progress.published().push_back(entry);
  }
  if (!writer_.write(progress)) log::warning("no answer could be sent in cycle {}", cycle.cycle());
}

}  // namespace prehend::service
