#include "common/service/clock_sync.hpp"

#include <fmt/format.h>

#include <chrono>
#include <functional>
#include <utility>

#include "common/base/clock.hpp"
#include "common/base/log.hpp"
#include "common/dds/topics.hpp"
#include "common/service/status_publisher.hpp"

namespace prehend::service {

namespace fdds = eprosima::fastdds::dds;

namespace {

constexpr Duration beacon_period = std::chrono::seconds(1);
/// Others find us soon after the start.
constexpr Duration early_beacon_period = std::chrono::milliseconds(100);
constexpr Duration early_time = std::chrono::seconds(2);
constexpr Duration min_between_beacons = std::chrono::milliseconds(20);
constexpr Duration noticed_step = std::chrono::milliseconds(100);

}  // namespace

/// Takes the time before anything else, so that nothing of ours counts as the network's delay.
class ClockSync::Listener final : public fdds::DataReaderListener {
 public:
  explicit Listener(ClockSync& sync) : sync_(sync) {}
  void on_data_available(fdds::DataReader* raw) override {
    const Time received = process_now();
    if (!reader_) reader_.emplace(raw);
    for (const auto& sample : reader_->take())
      if (!sample.info.gone) sync_.hear(sample, received);
  }

 private:
  ClockSync& sync_;
  std::optional<dds::Reader<v1::ClockBeacon>> reader_;
};

ClockSync::ClockSync(const std::string& service, const std::string& host, Time started)
    : started_(started), peers_(service, host) {}

Expected<std::unique_ptr<ClockSync>> ClockSync::create(dds::Participant& participant,
                                                       const std::string& service,
                                                       const std::string& host, Time started) {
  std::unique_ptr<ClockSync> made(new ClockSync(service, host, started));
  auto writer = participant.writer(dds::lab_beacon);
  if (!writer) return tl::unexpected(writer.error());
  made->writer_.emplace(std::move(*writer));
  made->listener_ = std::make_unique<Listener>(*made);
  if (auto reader = participant.reader(dds::lab_beacon, made->listener_.get()); !reader)
    return tl::unexpected(reader.error());
  return made;
}

void ClockSync::hear(const dds::Sample<v1::ClockBeacon>& sample, Time received) {
  clock::Peers::Heard heard;
  {
    const std::scoped_lock lock(mutex_);
    heard = peers_.hear(sample.data, sample.info.participant, received);
  }
  if (heard.step)
    log::warning("the clock of {} was set by {}; its stamps are moved to ours",
                 sample.data.service().to_string(), signed_seconds(*heard.step));
  if (heard.answer) send();
}

void ClockSync::send() {
  v1::ClockBeacon beacon;
  {
    const std::scoped_lock lock(mutex_);
    const Time now = process_now();
    if (now - last_ < min_between_beacons) return;
    last_ = now;
    const Duration step = prehend::clock_step();
    if (std::chrono::abs(step - step_) > noticed_step) {
      step_ = step;
      log::warning("the system's clock was set {} away from this process, which keeps its own",
                   signed_seconds(step));
    }
    beacon = peers_.beacon(now, step_);
  }
  // Our own reader hears it within this call.
  writer_->write(beacon);
}

Time ClockSync::beat(Time now) {
  if (now >= next_) {
    send();
    next_ = now + (now - started_ < early_time ? early_beacon_period : beacon_period);
  }
  return next_;
}

ClockSync::Ahead ClockSync::ahead(const dds::SampleInfo& info) const {
  const std::scoped_lock lock(mutex_);
  const Time now = process_now();
  return {peers_.ahead(info.participant, now), peers_.system_ahead(info.participant, now)};
}

std::string ClockSync::service_of(const dds::SampleInfo& info) const {
  const std::scoped_lock lock(mutex_);
  return peers_.service_of(info.participant);
}

Duration ClockSync::clock_step() const {
  const std::scoped_lock lock(mutex_);
  return step_;
}

}  // namespace prehend::service
