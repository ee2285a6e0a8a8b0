#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string_view>
#include <vector>

#include "common/dds/participant.hpp"

namespace prehend::service {

/// A sample on its way: the stamp to order it among topics, and how to hand it over.
struct Arrival {
  std::int64_t stamp_ns = 0;
  std::function<void()> deliver;
  dds::GuidPrefix writer{};    // its participant
  std::uint64_t instance = 0;  // hash of its key
  std::uint64_t index = 0;     // counts the writer's samples as they arrive; set by Input
};

/// What has come on a topic and is not handed over yet: live only before run(), in lockstep until
/// due.
struct Input {
  struct Writer {
    std::uint64_t first = 0;     // the instance that it wrote first
    std::uint64_t received = 0;  // samples
  };

  std::string_view topic;
  std::vector<Arrival> waiting;
  std::map<dds::GuidPrefix, Writer> writers;

  void add(Arrival arrival);
  std::uint64_t received_from(const dds::GuidPrefix& writer) const;
  /// Orders arrivals of this topic by writer and sequence. Which writer is first depends on what
  /// they write, not on who they are in this run.
  void sort(std::vector<Arrival>& arrivals) const;
};

/// The inputs of a service. Not safe for use from several threads: the shell locks.
class Inbox {
 public:
  /// Equal stamps are handed over in the order of the topics' names, whoever subscribed first.
  Input& add(std::string_view topic);
  const std::vector<std::unique_ptr<Input>>& inputs() const { return inputs_; }
  /// Everything that waits, topic by topic.
  std::vector<Arrival> take_all();

 private:
  std::vector<std::unique_ptr<Input>> inputs_;
};

/// Hands over in order of the stamps, and equal ones as they stand in `due`.
void deliver(std::vector<Arrival>& due);

}  // namespace prehend::service
