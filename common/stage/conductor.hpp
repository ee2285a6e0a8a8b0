#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/time.hpp"
#include "common/dds/participant.hpp"

namespace prehend::stage {

/// Leads services through time in lockstep: publishes lab/clock, waits for lab/progress. Whoever
/// feeds the services (a replayer, a test) publishes with a Participant in lockstep and tells the
/// conductor.
///
/// Every cycle names how many samples of each topic each writer has published so far, so that what
/// a service takes in a cycle does not depend on when messages arrive. What services publish in one
/// cycle they read in the next; settle() goes on at the same stamp until nothing new comes.
/// Several writers of a topic should write other instances each: by these they are put in order.
class Conductor {
 public:
  /// `services`: names of those that must answer every cycle; twice: two of that name.
  static Expected<Conductor> create(dds::Participant& participant,
                                    const std::vector<std::string>& services);

  /// The caller has published `count` samples on the topic.
  void published(std::string_view topic, std::uint64_t count = 1);

  /// One cycle at `now`. Fails when a service does not answer in `patience`, and names it; sooner
  /// when `dead`, asked several times a second, knows why one never will.
  Expected<void> step(Time now, std::chrono::milliseconds patience,
                      const std::function<std::optional<Error>()>& dead = nullptr);
  /// Cycles at `now` until one brings nothing new.
  Expected<void> settle(Time now, std::chrono::milliseconds patience);
  /// Samples published so far on each topic, by the caller and by the services, ends of instances
  /// among them.
  std::map<std::string, std::uint64_t> totals() const;

 private:
  Conductor(dds::Writer<v2::LabClock> clock, dds::Reader<v1::LabProgress> progress,
            dds::GuidPrefix self, const std::vector<std::string>& services);

  dds::Writer<v2::LabClock> clock_;
  dds::Reader<v1::LabProgress> progress_;
  using Counts = std::map<std::string, std::uint64_t>;  // samples by topic
  dds::GuidPrefix self_;
  std::multiset<std::string> services_;
  std::uint64_t cycle_ = 0;
  std::map<dds::GuidPrefix, Counts> published_;  // by participant
};

}  // namespace prehend::stage
