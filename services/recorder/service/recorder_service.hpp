#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "common/service/shell.hpp"
#include "services/recorder/core/topic_filter.hpp"
#include "services/recorder/service/operator_link.hpp"
#include "services/recorder/service/recorder.hpp"
#include "services/recorder/service/topic_listener.hpp"

namespace prehend::recorder {

/// A recorder at work: topics in, orders in, a file out.
class RecorderService {
 public:
  struct Options {
    TopicFilter topics;
    std::string rig;      // another one than lab.rig, or a pattern; empty: lab.rig
    Duration duration{};  // after which it ends the shell by itself; 0: never
    bool paused = false;  // waits for the order to start
    /// Called ten times a second, for who watches: keys, a line of progress.
    std::function<void()> on_tick = [] {};
  };
  struct Stats {
    bool paused = false;
    double elapsed_s = 0;
    std::size_t topics = 0;
    std::uint64_t messages = 0, bytes = 0, lost = 0;
    std::uint64_t ring_bytes = 0;  // held for snapshots
  };

  /// Begins to listen. The shell must outlive it.
  static Expected<std::unique_ptr<RecorderService>> create(service::Shell& shell, Recorder recorder,
                                                           Options options);

  /// start, resume, pause, snapshot, stop; in the shell's thread. Returns what to answer.
  Expected<std::string> execute(const std::string& order);
  Stats stats() const;

  /// Ends the file; after the shell has ended.
  Expected<void> finish();
  /// After finish().
  const Recorder& recorder() const { return recorder_; }

 private:
  RecorderService(service::Shell& shell, Recorder recorder, Options options);
  Expected<void> listen();
  Expected<std::string> snapshot();
  void note_losses();
  void tick(Time now);
  void tell_status();

  service::Shell& shell_;
  mutable std::mutex mutex_;  // guards the recorder, which the listener's thread feeds
  Recorder recorder_;
  Options options_;
  OperatorLink operator_;
  Time started_{};
  std::uint64_t counted_ = 0, lost_ = 0;     // as the status knows
  std::unique_ptr<TopicListener> listener_;  // last: its thread uses the rest
};

}  // namespace prehend::recorder
