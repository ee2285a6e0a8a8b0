#include "services/cli/service/self_reports.hpp"

namespace prehend::cli {

Expected<SelfReports> SelfReports::create(dds::Participant& participant) {
  auto statuses = participant.reader(dds::service_status);
  if (!statuses) return tl::unexpected(statuses.error());
  auto beacons = participant.reader(dds::lab_beacon);
  if (!beacons) return tl::unexpected(beacons.error());
  auto gates = participant.reader(dds::robot_gate);
  if (!gates) return tl::unexpected(gates.error());
  return SelfReports{std::move(*statuses), std::move(*beacons), std::move(*gates)};
}

}  // namespace prehend::cli
