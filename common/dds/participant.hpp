#pragma once

#include <algorithm>
#include <array>
#include <exception>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "common/dds/discovery_events.hpp"
#include "common/dds/guard/packet.hpp"
#include "common/dds/network.hpp"
#include "common/dds/peers.hpp"
#include "common/dds/release/fastdds.hpp"
#include "common/dds/security.hpp"
#include "common/dds/topics.hpp"

namespace prehend::dds {

struct ParticipantOptions {
  std::string name;  // shown to others at discovery
  int domain = 0;    // 0..232
  std::string rig;   // partition: samples stay within a rig
  Network network;   // how it reaches the others
  /// What it announces itself as, and whose keys it takes from a folder with many; empty: its name.
  std::string role;
  /// All topics reliable and complete, without deadlines: for recordings in lockstep.
  bool lockstep = false;
  /// Told of discovery in the whole domain, in its thread; must outlive the participant.
  DiscoveryEvents* listener = nullptr;
  /// ADDRESS:PORT at which this is the discovery server of a network of that kind.
  std::string serves = {};
};

/// Provenance of a received sample.
struct SampleInfo {
  Time sent;                   // the writer's clock
  GuidPrefix participant{};    // of the writer: first bytes of its identity
  std::uint64_t instance = 0;  // hash of the key, the same for all samples of an instance
  bool gone = false;  // the instance was disposed or lost its last writer: only its key is set
};

std::uint64_t instance_hash(const std::array<std::uint8_t, 16>& key);
std::uint64_t instance_hash(const rtps::InstanceHandle_t& handle);

template <class T>
struct Sample {
  T data;
  SampleInfo info;
};

/// Writes one topic. Not copied; lives no longer than its Participant.
template <class T>
class Writer {
 public:
  explicit Writer(eprosima::fastdds::dds::DataWriter* writer) : writer_(writer) {}
  /// False when the sample could not be queued (it timed out on a full history).
  bool write(const T& sample) { return succeeded(writer_->write(const_cast<T*>(&sample))); }
  /// Tells readers that the instance with this sample's key is gone, and forgets it.
  bool dispose(const T& key) {
    auto* sample = const_cast<T*>(&key);
    return succeeded(writer_->unregister_instance(sample, writer_->lookup_instance(sample)));
  }
  eprosima::fastdds::dds::DataWriter& raw() { return *writer_; }

 private:
  eprosima::fastdds::dds::DataWriter* writer_;
};

/// Reads one topic. Not copied; lives no longer than its Participant.
template <class T>
class Reader {
 public:
  explicit Reader(eprosima::fastdds::dds::DataReader* reader) : reader_(reader) {}

  /// Everything that has come since the last call, in the order of arrival.
  std::vector<Sample<T>> take() {
    std::vector<Sample<T>> samples;
    while (true) {
      Sample<T> sample;
      eprosima::fastdds::dds::SampleInfo info;
      if (!succeeded(reader_->take_next_sample(&sample.data, &info))) break;
      sample.info.gone = !info.valid_data;
      sample.info.sent = from_ns(info.source_timestamp.to_ns());
      sample.info.instance = instance_hash(info.instance_handle);
      std::copy_n(info.sample_identity.writer_guid().guidPrefix.value,
                  sample.info.participant.size(), sample.info.participant.begin());
      if (info.valid_data) {
        first_.try_emplace(sample.info.instance, sample.data);
      } else {
        if (info.instance_state == eprosima::fastdds::dds::ALIVE_INSTANCE_STATE) continue;
        const auto known = first_.extract(sample.info.instance);
        if (!known) continue;  // came and went before we saw it
        sample.data = known.mapped();
      }
      samples.push_back(std::move(sample));
    }
    return samples;
  }
  /// Living instances that have been seen.
  std::size_t instances() const { return first_.size(); }
  eprosima::fastdds::dds::DataReader& raw() { return *reader_; }

 private:
  eprosima::fastdds::dds::DataReader* reader_;
  /// The first sample of each living instance: the end of an instance does not bring its key.
  std::map<std::uint64_t, T> first_;
};

/// A type whose messages may be damaged: what the generated code throws over some of them would end
/// the process, in a thread of Fast DDS.
template <class P>
class NoThrowPubSubType final : public P {
 public:
  bool deserialize(PayloadArgument payload, void* data) override {
    try {
      return is_first_representation(payload) && P::deserialize(payload, data);
    } catch (const std::exception&) {
      return false;
    }
  }
};

/// A place in the DDS domain. QoS comes from topics.hpp, transport from the profile. Every call is
/// safe from one thread at a time; each writer and reader likewise.
class Participant {
 public:
  /// With keys it returns when the peers that answer have been let in or refused.
  static Expected<Participant> create(const ParticipantOptions& options);
  Participant(Participant&&) noexcept;
  Participant& operator=(Participant&&) noexcept;
  /// Waits until readers have what was written last and reliably, for at most 1 s.
  ~Participant();

  /// Those that it joined with; nothing when it is not secured. They live as long as it does.
  const Keys* keys() const;
  /// Peers that were refused, or that refuse us, with the reason, and how often: «mallory, whose
  /// keys are of another authority». At most 32 different ones. Safe from every thread.
  std::map<std::string, std::uint64_t> refused() const;
  /// Peers that are here, by SampleInfo::participant. Safe from every thread.
  std::map<GuidPrefix, Peers::Presented> present() const;
  /// What the writer of a sample is: in a secured lab by its certificate, otherwise as it announces
  /// itself, which it does before it writes. Nothing: it is not known, or has no role of ours. Safe
  /// from every thread.
  std::optional<Role> role_of(const GuidPrefix& whose) const;
  /// As others see it in SampleInfo::participant.
  GuidPrefix identity() const;

  template <class P>
  Expected<Writer<typename P::type>> writer(const Topic<P>& topic) {
    static_assert(is_listed<P>, "typed_topics in topics.hpp lacks this topic");
    if (const auto known = confirm_listed(topic.name); !known) return tl::unexpected(known.error());
    auto made = make_writer(topic.name, topic.qos,
                            eprosima::fastdds::dds::TypeSupport(new NoThrowPubSubType<P>()));
    if (!made) return tl::unexpected(made.error());
    return Writer<typename P::type>(*made);
  }
  /// listener: told of every arrival, in the thread that received it; nullptr: none.
  template <class P>
  Expected<Reader<typename P::type>> reader(
      const Topic<P>& topic, eprosima::fastdds::dds::DataReaderListener* listener = nullptr) {
    static_assert(is_listed<P>, "typed_topics in topics.hpp lacks this topic");
    if (const auto known = confirm_listed(topic.name); !known) return tl::unexpected(known.error());
    auto made =
        make_reader(topic.name, topic.qos,
                    eprosima::fastdds::dds::TypeSupport(new NoThrowPubSubType<P>()), listener);
    if (!made) return tl::unexpected(made.error());
    return Reader<typename P::type>(*made);
  }

 private:
  friend class RawReader;
  friend class RawWriter;
  struct State;
  explicit Participant(std::unique_ptr<State> state);
  static Expected<Participant> join(const ParticipantOptions& options);
  static Expected<void> confirm_listed(std::string_view topic);
  Expected<eprosima::fastdds::dds::DataWriter*> make_writer(
      std::string_view topic, const TopicQos& contract, eprosima::fastdds::dds::TypeSupport type,
      bool raw = false);
  /// raw: the reader is told also of matches; the writer unregisters an instance without disposing
  /// it. ask_for_keys: writers shall send them beside the samples.
  Expected<eprosima::fastdds::dds::DataReader*> make_reader(
      std::string_view topic, const TopicQos& contract, eprosima::fastdds::dds::TypeSupport type,
      eprosima::fastdds::dds::DataReaderListener* listener, bool raw = false,
      bool ask_for_keys = false);
  eprosima::fastdds::dds::Subscriber* subscriber();
  std::unique_ptr<State> state_;
};

}  // namespace prehend::dds
