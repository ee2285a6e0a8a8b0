#pragma once

#include "common/dds/participant.hpp"
#include "common/dds/topics.hpp"

namespace prehend::cli {

/// What services, their clocks and robots' gates say of themselves.
struct SelfReports {
  static Expected<SelfReports> create(dds::Participant& participant);

  dds::Reader<v1::ServiceStatus> statuses;
  dds::Reader<v1::ClockBeacon> beacons;
  dds::Reader<v1::GateState> gates;
};

}  // namespace prehend::cli
