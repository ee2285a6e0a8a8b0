#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "common/dds/raw.hpp"
#include "services/recorder/core/topic_filter.hpp"
#include "services/recorder/service/recording_file.hpp"

namespace prehend::recorder {

/// Finds the topics of a rig, also late ones, and hands on everything that comes on them.
class TopicListener {
 public:
  struct Options {
    dds::ParticipantOptions lab;  // its rig may be a pattern, * for all
    TopicFilter topics;           // which of them it hands on
    /// Held for a disk that is slower than the topics for a while; what is more is lost and
    /// counted.
    std::uint64_t queue_bytes = 48'000'000;
    /// Finds keys in messages of a type, for writers that do not send them.
    std::function<dds::KeyOf(const std::string& type)> keys = [](const std::string&) {
      return dds::KeyOf();
    };
    /// Called in the discovery's thread when poll() has something to do.
    std::function<void()> on_found = [] {};
  };
  /// Called in one thread of the listener's own.
  using Take = std::function<void(const Source& source, dds::RawSample&& sample)>;

  static Expected<std::unique_ptr<TopicListener>> create(const Options& options, Take take);
  ~TopicListener();

  /// Begins to read topics that were found since the last call. Call it often: what a volatile
  /// topic says before is not heard.
  void poll();
  /// Reads no more, and returns when everything received has been handed on.
  void stop();

  /// By topic: gaps in writers' numbers, and what the queue could not take. A topic that is read
  /// and has lost nothing has 0.
  std::map<std::string, std::uint64_t> lost() const;
  std::size_t topic_count() const { return readers_.size(); }

 private:
  struct Reading {
    Source source;
    std::unique_ptr<dds::RawReader> reader;
    std::uint64_t overflow = 0;  // guarded by queue_mutex_
    bool complained = false;
    bool keyless = false;  // nothing tells its keys but what its writers send
  };
  struct Item {
    const Source* source;
    dds::RawSample sample;
  };

  TopicListener(const Options& options, Take take);
  void read(const dds::DiscoveredWriter& found, const std::string& rig);
  void drain();
  void queue(Reading& reading, dds::RawSample&& sample);
  void hand_on(const std::stop_token& stop);
  std::optional<std::string> rig_of(const dds::DiscoveredWriter& found) const;

  Options options_;
  Take take_;
  std::mutex found_mutex_;
  std::vector<dds::DiscoveredWriter> found_;
  mutable std::mutex queue_mutex_;
  std::condition_variable_any queue_news_;
  std::condition_variable queue_empty_;
  std::vector<Item> queue_;
  std::uint64_t queue_bytes_ = 0;
  bool handing_on_ = false;
  dds::Discovery discovery_;
  std::optional<dds::Participant> participant_;
  std::map<std::string, std::unique_ptr<Reading>> readers_;  // by topic
  std::map<std::string, std::uint64_t> lost_at_stop_;
  std::jthread thread_;
};

}  // namespace prehend::recorder
