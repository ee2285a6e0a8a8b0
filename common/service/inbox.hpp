#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>
#include <vector>

namespace prehend::service {

/// A sample on its way: the stamp to order it among topics, and how to hand it over.
struct Arrival {
  std::int64_t stamp_ns = 0;
  std::function<void()> deliver;
  std::uint64_t index = 0;  // counts the topic's samples as they arrive
};

/// What has come on a topic and is not handed over yet: live only before run(), in lockstep until
/// due.
struct Input {
  std::string_view topic;
  std::vector<Arrival> waiting;
  std::uint64_t received = 0;
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

/// Hands over in the order (stamp, topic, sequence). `due` is sorted by topic and sequence.
void deliver(std::vector<Arrival>& due);

}  // namespace prehend::service
