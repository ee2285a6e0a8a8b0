#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/dds/discovery_events.hpp"
#include "common/dds/participant.hpp"

/// Topics whose type is not known here: found by discovery, read and written as the bytes on the
/// wire.
namespace prehend::dds {

using Guid = std::array<std::uint8_t, 16>;

/// A topic as discovery tells of it.
struct RawTopic {
  std::string name, type;
  bool keyed = true;
  /// What its writer offers. The depth is not told by discovery: it comes from topics.hpp, else it
  /// is 1 for transient local topics and 64 for others.
  TopicQos qos;
};
/// One of ours.
inline RawTopic raw_topic(const TopicInfo& topic) {
  return {std::string(topic.name), topic.type_name(), topic.keyed(), topic.qos};
}

/// A change of an instance: its bytes, or its end.
struct RawSample {
  enum class Kind : std::uint8_t { data, disposed, unregistered };
  Kind kind = Kind::data;
  std::vector<std::uint8_t> payload;  // with the encapsulation header; empty unless data
  Guid instance{}, writer{};          // the key, or its hash; zero where the topic has no key
  std::uint64_t sequence = 0;         // counts the writer's samples, from 1
  Time sent, received;                // clocks of the writer and of this machine
};

/// The instance that a message belongs to, from its key fields or, with key_only, from a payload
/// that is nothing but those; nothing when it cannot be told.
using KeyOf =
    std::function<std::optional<Guid>(std::span<const std::uint8_t> payload, bool key_only)>;

/// The message in a sample; false when it is damaged or does not fit the topic's type: the message
/// may then be half filled.
template <class P>
[[nodiscard]] bool decode(const Topic<P>&, const RawSample& sample, typename P::type& message) {
  rtps::SerializedPayload_t payload(static_cast<std::uint32_t>(sample.payload.size()));
  std::copy(sample.payload.begin(), sample.payload.end(), payload.data);
  payload.length = payload.max_size;
  NoThrowPubSubType<P> type;
  return payload.length >= 4 && deserialize(type, payload, &message) &&
         is_whole(type, payload, &message);
}

/// A message as it is on the wire.
template <class P>
std::vector<std::uint8_t> encode(const Topic<P>&, const typename P::type& message) {
  P type;
  rtps::SerializedPayload_t payload(serialized_size(type, &message));
  if (!serialize(type, &message, payload)) return {};
  return {payload.data, payload.data + payload.length};
}

/// A writer that has appeared, changed its QoS or gone.
struct DiscoveredWriter {
  RawTopic topic;
  Guid writer{};
  std::vector<std::string> rigs;  // its partitions
  bool gone = false;
};

/// Tells of every writer in the domain, in the discovery's thread, where no endpoint may be made.
/// Give it to ParticipantOptions::listener; it must outlive the participant.
class Discovery : public DiscoveryEvents {
 public:
  explicit Discovery(std::function<void(const DiscoveredWriter&)> found)
      : found_(std::move(found)) {}
  void on_endpoint(const FoundEndpoint& endpoint) override;

 private:
  std::function<void(const DiscoveredWriter&)> found_;
};

/// Reads any topic, keeping all. Lives no longer than its Participant.
class RawReader {
 public:
  /// Called for every change in the thread that received it, one call at a time.
  using Take = std::function<void(RawSample&&)>;
  /// Without `key`, writers are asked to send keys beside their samples. Fast DDS does; Cyclone DDS
  /// does not send to readers that ask so.
  static Expected<std::unique_ptr<RawReader>> create(Participant& participant,
                                                     const RawTopic& topic, Take take,
                                                     KeyOf key = {});
  ~RawReader();

  /// Samples that were sent after their writer was matched and never came: gaps in the writers'
  /// numbers. Safe from every thread.
  std::uint64_t lost() const;
  std::uint64_t received() const;
  /// Matched now.
  std::size_t writers() const;

 private:
  class Listener;
  RawReader(std::unique_ptr<Listener> listener, eprosima::fastdds::dds::Subscriber* subscriber,
            eprosima::fastdds::dds::DataReader* reader);
  std::unique_ptr<Listener> listener_;
  eprosima::fastdds::dds::Subscriber* subscriber_;
  eprosima::fastdds::dds::DataReader* reader_;
};

/// Writes any topic, with keys and QoS as given. Lives no longer than its Participant.
class RawWriter {
 public:
  static Expected<RawWriter> create(Participant& participant, const RawTopic& topic);
  /// Writes or ends the sample's instance; `sent` becomes its source time stamp. False when it
  /// could not be queued.
  bool write(const RawSample& sample, Time sent);
  /// Matched now.
  std::size_t readers() const;
  eprosima::fastdds::dds::DataWriter& raw() { return *writer_; }

 private:
  explicit RawWriter(eprosima::fastdds::dds::DataWriter* writer) : writer_(writer) {}
  eprosima::fastdds::dds::DataWriter* writer_;
};

}  // namespace prehend::dds
