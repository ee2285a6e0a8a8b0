#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/dds/raw.hpp"

namespace prehend::console {

/// A change on a topic, by the topic's place in the table.
struct Letter {
  std::size_t topic = 0;
  dds::Guid instance{};
  std::int64_t sent_ns = 0;
  std::shared_ptr<const std::string> payload;  // nothing: the instance has ended
  std::int64_t heard_ns = 0;                   // in a recording; of a lab: just now
};

/// What has come since it was last emptied: of each instance the newest, of topics that keep all
/// every message. Threads that receive never wait here for more than a copy. Safe from every
/// thread.
class Mailbox {
 public:
  /// keeps_all: by topic. ring: called by who brings the first letter after it was emptied.
  explicit Mailbox(
      std::vector<bool> keeps_all, std::function<void()> ring = [] {})
      : keeps_all_(std::move(keeps_all)), ring_(std::move(ring)) {}

  void put(std::size_t topic, dds::RawSample&& sample);
  /// In the order of arrival, as far as it matters.
  std::vector<Letter> take();
  /// What was not kept because there was too much of it.
  std::uint64_t lost() const;

 private:
  static constexpr std::size_t max_instances = 4096, max_queued = 4096;

  /// Under the mutex.
  void keep(std::size_t topic, Letter letter);

  const std::vector<bool> keeps_all_;
  const std::function<void()> ring_;
  mutable std::mutex mutex_;  // guards what follows
  std::map<std::pair<std::size_t, dds::Guid>, Letter> newest_;
  std::deque<Letter> queued_;
  std::uint64_t lost_ = 0;
};

}  // namespace prehend::console
