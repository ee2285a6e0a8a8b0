#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <string>

#include "common/dds/participant.hpp"
#include "common/service/inbox.hpp"

namespace prehend::service {

/// Follows lab/clock: each cycle hands over the inputs that are due, in the order (stamp, topic,
/// writer, sequence), then comes one tick, then lab/progress is answered. Nothing of it depends on
/// when messages arrive. Not safe for use from several threads: the shell locks.
class LockstepLoop {
 public:
  static Expected<LockstepLoop> create(dds::Participant& participant, const std::string& service);

  /// A cycle of the clock has come.
  void add(const v2::LabClock& cycle) { cycles_.push_back(cycle); }
  /// Of lab/clock.
  Time now() const { return now_; }
  using Published = std::map<std::string, std::uint64_t, std::less<>>;  // samples of each topic
  /// One cycle, if everything that it speaks of has come. False: wait for more.
  bool run_cycle(Inbox& inbox, const std::function<void(Time)>& tick, const Published& published);

 private:
  LockstepLoop(dds::Writer<v1::LabProgress> writer, std::string service);
  void answer(const v2::LabClock& cycle, std::uint32_t waiting, const Published& published);

  dds::Writer<v1::LabProgress> writer_;
  std::string service_;
  std::deque<v2::LabClock> cycles_;  // not yet run
  Time now_{};
};

}  // namespace prehend::service
