#include "common/service/status_publisher.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <utility>

#include "common/base/log.hpp"
#include "common/dds/topics.hpp"
#include "common/service/instance.hpp"

namespace prehend::service {
namespace {

constexpr Duration status_period = std::chrono::seconds(1);

/// Bytes of memory in use, from the kernel.
double resident_memory() {
  std::ifstream statm("/proc/self/statm");
  long total = 0, resident = 0;
  statm >> total >> resident;
  return static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

}  // namespace

std::string signed_seconds(Duration duration) {
  return fmt::format("{:+.3f} s", to_seconds(duration));
}

std::string host_name() {
  char name[65] = {};
  gethostname(name, 64);
  return name;
}

StatusPublisher::StatusPublisher(dds::Participant& participant,
                                 dds::Writer<v1::ServiceStatus> writer, Time started)
    : participant_(&participant), writer_(std::move(writer)), started_(started) {}

Expected<StatusPublisher> StatusPublisher::create(dds::Participant& participant,
                                                  const std::string& name, const std::string& host,
                                                  const std::string& instance, Time started) {
  auto writer = participant.writer(dds::service_status);
  if (!writer) return tl::unexpected(writer.error());
  StatusPublisher made(participant, std::move(*writer), started);
  made.message_.name(name.c_str());
  made.message_.host(host.c_str());
  made.message_.service(status_key(name, host, instance).c_str());
  return made;
}

Expected<void> StatusPublisher::tell_settings(const std::map<std::string, std::string>& settings) {
  auto writer = participant_->writer(dds::service_settings);
  if (!writer) return tl::unexpected(writer.error());
  settings_.emplace(std::move(*writer));
  v1::ServiceSettings message;
  message.service(message_.service());
  message.stamp_ns(to_ns(started_));
  message.name(message_.name());
  for (const auto& [key, value] : settings) {
    if (key.starts_with("lab.") || key.starts_with("keys.")) continue;
    v1::GivenSetting given;
    given.key(key.c_str());
    given.value(value.c_str());
    if (given.value().to_string() == value)
      message.settings().push_back(given);
    else
      log::warning("{}: is too long, so no recording knows of it", key);  // a part would mislead
  }
  settings_->write(message);
  return {};
}

void StatusPublisher::count_refusals(Status& status) {
  for (const dds::Dropped& dropped : dds::dropped_packets()) {
    const auto reason = dds::verdict_names[static_cast<std::size_t>(dropped.reason)];
    std::uint64_t& told = dropped_[dropped.reason];
    if (told == 0) log::warning("dropped: {}, from {}", reason, dropped.last_source);
    status.drop(reason, dropped.count - std::exchange(told, dropped.count));
  }
  for (const auto& [peer, count] : participant_->refused()) {
    std::uint64_t& told = refused_[peer];
    if (told == 0) log::warning("peer refused: {}", peer);
    status.drop("peer refused: " + peer, count - std::exchange(told, count));
  }
}

void StatusPublisher::publish(Time now, Status& status, Duration clock_step) {
  count_refusals(status);
  status.fill(message_, now);
  message_.uptime(to_seconds(now - started_));
  message_.resident(resident_memory());
  if (message_.message().size() == 0 && clock_step != Duration::zero())
    message_.message(("the system's clock was set " + signed_seconds(clock_step) +
                      " away from this process, which keeps its own until it is started anew")
                         .c_str());
  writer_.write(message_);
  next_ = now + status_period;
}

Time StatusPublisher::beat(Time now, Status& status, Duration clock_step) {
  if (now >= next_) publish(now, status, clock_step);
  return next_;
}

}  // namespace prehend::service
