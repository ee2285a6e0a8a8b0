#pragma once

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "common/dds/participant.hpp"
#include "common/dds/raw.hpp"

namespace prehend::ros2 {

/// Messages of a topic until they are read. Lives no longer than its participant.
class TopicQueue {
 public:
  /// Of more than `kept` the oldest are lost.
  static Expected<std::unique_ptr<TopicQueue>> create(dds::Participant& participant,
                                                      const dds::RawTopic& topic, std::size_t kept);
  ~TopicQueue();
  TopicQueue(const TopicQueue&) = delete;
  TopicQueue& operator=(const TopicQueue&) = delete;

  /// The oldest; waits for one at most that long.
  std::optional<dds::RawSample> next(Duration timeout);

 private:
  explicit TopicQueue(std::size_t kept) : kept_(kept) {}
  void keep(dds::RawSample&& sample);

  const std::size_t kept_;
  std::mutex mutex_;  // guards heard_
  std::condition_variable come_;
  std::deque<dds::RawSample> heard_;
  std::unique_ptr<dds::RawReader> reader_;  // ends first: what it receives goes into heard_
};

}  // namespace prehend::ros2
