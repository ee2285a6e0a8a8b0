#include "services/recorder/service/recorder_service.hpp"

#include "common/base/clock.hpp"
#include "common/service/membership.hpp"
#include "services/recorder/service/describe.hpp"

namespace prehend::recorder {

Expected<std::unique_ptr<RecorderService>> RecorderService::create(service::Shell& shell,
                                                                   Recorder recorder,
                                                                   Options options) {
  std::unique_ptr<RecorderService> made(
      new RecorderService(shell, std::move(recorder), std::move(options)));
  if (const auto listens = made->listen(); !listens) return tl::unexpected(listens.error());
  shell.on_tick(std::chrono::milliseconds(100),
                [service = made.get()](Time now) { service->tick(now); });
  shell.status().running();
  return made;
}

RecorderService::RecorderService(service::Shell& shell, Recorder recorder, Options options)
    : shell_(shell),
      recorder_(std::move(recorder)),
      options_(std::move(options)),
      operator_(shell, "recorder", [this](const std::string& order) { return execute(order); }),
      started_(process_now()) {
  if (options_.paused) recorder_.pause(started_);
}

Expected<void> RecorderService::listen() {
  auto keys = keys_of_types();
  if (!keys) return tl::unexpected(keys.error());
  dds::ParticipantOptions lab = service::membership(shell_.config(), "recorder");
  if (!options_.rig.empty()) lab.rig = options_.rig;
  auto listener =
      TopicListener::create({.lab = std::move(lab),
                             .topics = options_.topics,
                             .keys = std::move(*keys),
                             .on_found = [this] { shell_.post([this] { listener_->poll(); }); }},
                            [this](const Source& source, dds::RawSample&& sample) {
                              const std::scoped_lock lock(mutex_);
                              recorder_.take(source, std::move(sample));
                            });
  if (!listener) return tl::unexpected(listener.error());
  listener_ = std::move(*listener);
  return {};
}

Expected<std::string> RecorderService::execute(const std::string& order) {
  if (order == "stop") {
    shell_.stop();
    return "stopped";
  }
  if (order == "snapshot") return snapshot();
  const std::scoped_lock lock(mutex_);
  if (order == "pause") {
    recorder_.pause(shell_.now());
    return "paused";
  }
  if (order == "start" || order == "resume") {
    recorder_.resume(shell_.now());
    return "recording";
  }
  return fail("unknown order '" + order + "'", "recorder",
              "start, stop, pause, resume or snapshot");
}

// Written without the lock: the disk may take seconds, and samples come on.
Expected<std::string> RecorderService::snapshot() {
  std::unique_lock lock(mutex_);
  const auto taken = recorder_.snapshot(shell_.now());
  lock.unlock();
  if (!taken) return tl::unexpected(taken.error());
  const auto written = taken->write();
  if (!written) return tl::unexpected(written.error());
  lock.lock();
  recorder_.add(*written);
  return written->path.string();
}

RecorderService::Stats RecorderService::stats() const {
  const std::scoped_lock lock(mutex_);
  return {.paused = recorder_.paused(),
          .elapsed_s = to_seconds(shell_.now() - started_),
          .topics = listener_->topic_count(),
          .messages = recorder_.messages(),
          .bytes = recorder_.bytes(),
          .lost = recorder_.lost(),
          .ring_bytes = recorder_.ring_bytes()};
}

Expected<void> RecorderService::finish() {
  listener_->stop();
  const std::scoped_lock lock(mutex_);
  note_losses();
  return recorder_.close();
}

void RecorderService::note_losses() {
  for (const auto& [topic, count] : listener_->lost()) recorder_.set_lost(topic, count);
}

void RecorderService::tick(Time now) {
  listener_->poll();
  {
    const std::scoped_lock lock(mutex_);
    note_losses();
    recorder_.tick(now);
    if (recorder_.error()) shell_.stop(exit_broken);
    tell_status();
  }
  options_.on_tick();
  if (options_.duration > Duration{} && now - started_ >= options_.duration) shell_.stop();
}

void RecorderService::tell_status() {
  shell_.status().count("messages", recorder_.messages() - counted_);
  counted_ = recorder_.messages();
  if (const auto lost = recorder_.lost(); lost > lost_) {
    shell_.status().drop("not recorded", lost - lost_);
    lost_ = lost;
  }
}

}  // namespace prehend::recorder
