#pragma once

#include "services/mapping/tools/judging/answerer.hpp"

namespace prehend::mapping {

/// When takes begin for those who answer, unless they do so live: 2026.
inline constexpr Duration take_beginning = std::chrono::seconds(1'767'225'600);

/// The same, told at this date.
Told at_date(Told told, Duration beginning);

/// Our own mapping, called as the live process is in lockstep: it hears what the messages say, not
/// the values that they were made of, in cycles that end with a tick. So it answers as that process
/// does, to the last bit.
class OwnByMessages : public Answerer {
 public:
  OwnByMessages(const model::HandModel& hand, Mapping mapping)
      : hand_(hand), mapping_(std::move(mapping)) {}

  Expected<std::vector<gate::Command>> answer(const Told& told, Time now) override;

 private:
  void take(const Command& command, std::vector<gate::Command>& commands);

  const model::HandModel& hand_;
  Mapping mapping_;
  std::uint64_t sequence_ = 0;
};

}  // namespace prehend::mapping
