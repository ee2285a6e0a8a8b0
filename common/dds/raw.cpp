#include "common/dds/raw.hpp"

#include <algorithm>
#include <cstring>
#include <deque>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <map>
#include <mutex>
#include <set>

namespace prehend::dds {

namespace {

Guid guid_of(const rtps::GUID_t& guid) {
  Guid bytes{};
  std::copy_n(guid.guidPrefix.value, 12, bytes.begin());
  std::copy_n(guid.entityId.value, 4, bytes.begin() + 12);
  return bytes;
}

Guid guid_of(const rtps::InstanceHandle_t& handle) {
  Guid bytes{};
  std::copy_n(static_cast<const rtps::octet*>(handle.value), 16, bytes.begin());
  return bytes;
}

/// A type that is nothing but its bytes. Its key is the one that came with the sample; where none
/// came, it is what `key` finds in them.
class RawType : public fdds::TopicDataType {
 public:
  using Payload = rtps::SerializedPayload_t;
  using Handle = rtps::InstanceHandle_t;

#if PREHEND_FAST_DDS == 2
  RawType(const std::string& name, bool keyed, KeyOf key = {}) : key_(std::move(key)) {
    setName(name.c_str());
    m_isGetKeyDefined = keyed;
    m_typeSize = first_size;
  }
  bool serialize(void* data, Payload* payload) override {
    return put(bytes(data), *payload);
  }
  bool deserialize(Payload* payload, void* data) override {
    return take(*payload, data);
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<std::uint32_t>(bytes(data).size()); };
  }
  bool getKey(void* data, Handle* handle, bool) override {
    return find(data, *handle);
  }
  void* createData() override {
    return new RawSample;
  }
  void deleteData(void* data) override {
    delete static_cast<RawSample*>(data);
  }
#else
  RawType(const std::string& name, bool keyed, KeyOf key = {}) : key_(std::move(key)) {
    set_name(name);
    is_compute_key_provided = keyed;
    max_serialized_type_size = first_size;
  }
  bool serialize(const void* data, Payload& payload, fdds::DataRepresentationId_t) override {
    return put(bytes(data), payload);
  }
  bool deserialize(Payload& payload, void* data) override {
    return take(payload, data);
  }
  std::uint32_t calculate_serialized_size(const void* data, fdds::DataRepresentationId_t) override {
    return static_cast<std::uint32_t>(bytes(data).size());
  }
  bool compute_key(const void* data, Handle& handle, bool) override {
    return find(data, handle);
  }
  bool compute_key(Payload& payload, Handle& handle, bool) override {
    RawSample sample;
    return take(payload, &sample) && find(&sample, handle);
  }
  void* create_data() override {
    return new RawSample;
  }
  void delete_data(void* data) override {
    delete static_cast<RawSample*>(data);
  }
#endif

 private:
  static constexpr std::uint32_t first_size = 256;  // histories grow as needed

  static const std::vector<std::uint8_t>& bytes(const void* data) {
    return static_cast<const RawSample*>(data)->payload;
  }
  static bool put(const std::vector<std::uint8_t>& bytes, Payload& payload) {
    if (bytes.size() > payload.max_size || bytes.size() < 4) return false;
    std::memcpy(payload.data, bytes.data(), bytes.size());
    payload.length = static_cast<std::uint32_t>(bytes.size());
    payload.encapsulation = bytes[1] & 1 ? CDR_LE : CDR_BE;
    return true;
  }
  static bool take(const Payload& payload, void* data) {
    static_cast<RawSample*>(data)->payload.assign(payload.data, payload.data + payload.length);
    return true;
  }
  bool find(const void* data, Handle& handle) const {
    if (!has_key(*this)) return false;
    const auto& sample = *static_cast<const RawSample*>(data);
    const auto found = key_ && !sample.payload.empty() ? key_(sample.payload, false) : std::nullopt;
    const Guid& key = found ? *found : sample.instance;
    std::copy(key.begin(), key.end(), static_cast<rtps::octet*>(handle.value));
    return true;
  }

  KeyOf key_;
};

}  // namespace

void Discovery::on_endpoint(const FoundEndpoint& endpoint) {
  if (!endpoint.writes) return;
  DiscoveredWriter found;
  found.writer = guid_of(endpoint.guid);
  found.gone = endpoint.news == News::gone;
  found.topic = {endpoint.topic, endpoint.type, endpoint.keyed, endpoint.qos};
  const TopicInfo* known = find_topic(found.topic.name);
  TopicQos& qos = found.topic.qos;
  qos.writer_depth = known ? known->qos.writer_depth : qos.transient_local ? 1 : 64;
  found.rigs = endpoint.rigs;
  found_(found);
}

class RawReader::Listener : public fdds::DataReaderListener {
 public:
  /// kept: samples that a writer keeps of each instance for who comes late; 0: none, or all.
  Listener(Take take, KeyOf key, int kept)
      : take_(std::move(take)), key_(std::move(key)), kept_(kept) {}

  void on_subscription_matched(fdds::DataReader*,
                               const fdds::SubscriptionMatchedStatus& status) override {
    const std::scoped_lock lock(mutex_);
    const Guid writer = guid_of(status.last_publication_handle);
    if (status.current_count_change > 0)
      writers_.try_emplace(writer);
    else if (status.current_count_change < 0)
      forget(writer);
  }

  void on_data_available(fdds::DataReader* reader) override {
    const std::scoped_lock lock(mutex_);
    std::vector<RawSample> samples;
    std::vector<fdds::SampleInfo> infos;
    while (true) {
      fdds::SampleInfo& info = infos.emplace_back();
      RawSample& sample = samples.emplace_back();
      if (!succeeded(reader->take_next_sample(&sample, &info))) break;
      sample.instance = guid_of(info.instance_handle);
      sample.writer = guid_of(info.sample_identity.writer_guid());
      sample.sequence = info.sample_identity.sequence_number().to64long();
      sample.sent = from_ns(info.source_timestamp.to_ns());
      sample.received = from_ns(info.reception_timestamp.to_ns());
    }
    samples.pop_back();
    infos.pop_back();
    if (key_)
      for (std::size_t i = 0; i < samples.size(); ++i) find_key(samples[i], infos[i].valid_data);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      samples[i].kind = kind_of(samples, infos, i);
      if (samples[i].kind != RawSample::Kind::data) end(samples[i].instance);
    }
    for (RawSample& sample : as_written(std::move(samples))) {
      count(sample);
      take_(std::move(sample));
    }
  }

  std::size_t writers() {
    const std::scoped_lock lock(mutex_);
    return writers_.size();
  }

  std::atomic<std::uint64_t> lost = 0, received = 0;

 private:
  struct Seen {
    std::uint64_t sequence = 0;
    /// Of what the writer had kept from before: how many of each instance. Nothing once it is known
    /// to be live.
    std::map<Guid, int> kept;
    bool live = false;
  };
  /// Instances whose end is remembered: what becomes of others next may be told wrongly.
  static constexpr std::size_t max_ended = 4096;

  /// The wire says whether an instance was disposed or unregistered, the middleware only how it is
  /// now: with several changes at once, the next life of the instance tells how this one ended.
  RawSample::Kind kind_of(const std::vector<RawSample>& samples,
                          const std::vector<fdds::SampleInfo>& infos, std::size_t i) {
    using Kind = RawSample::Kind;
    const auto ended = std::pair(samples[i].instance, samples[i].writer);
    if (infos[i].valid_data) {
      disposed_.erase(ended);
      return Kind::data;
    }
    bool disposed = infos[i].instance_state == fdds::NOT_ALIVE_DISPOSED_INSTANCE_STATE;
    for (std::size_t j = i + 1; j < samples.size(); ++j)
      if (infos[j].valid_data && samples[j].instance == samples[i].instance) {
        disposed = infos[j].disposed_generation_count > infos[i].disposed_generation_count;
        break;
      }
    // What was disposed by this writer can only be unregistered by it next.
    if (disposed && disposed_.insert(ended).second) return Kind::disposed;
    disposed_.erase(ended);
    return Kind::unregistered;
  }

  /// With the end of an instance a writer may send its key fields instead of their hash. Fast DDS
  /// hands them on as if they were the hash, when they are short enough.
  void find_key(RawSample& sample, bool data) {
    if (data) {
      instances_.insert(sample.instance);
    } else if (!instances_.contains(sample.instance)) {
      const auto key = key_(sample.instance, true);
      if (key && instances_.contains(*key)) sample.instance = *key;
    }
  }

  /// Instances come and go without number: of those that have ended only the last are remembered.
  void end(const Guid& instance) {
    ended_.push_back(instance);
    if (ended_.size() <= max_ended) return;
    const Guid oldest = ended_.front();
    ended_.pop_front();
    instances_.erase(oldest);
    for (auto it = disposed_.lower_bound({oldest, {}});
         it != disposed_.end() && it->first == oldest;)
      it = disposed_.erase(it);
  }

  /// What has come at once comes instance by instance: gives each writer's samples, where they are
  /// among those of others, the order in which it wrote them.
  static std::vector<RawSample> as_written(std::vector<RawSample> samples) {
    std::map<Guid, std::vector<std::size_t>> places;  // of each writer's samples, ascending
    for (std::size_t i = 0; i < samples.size(); ++i) places[samples[i].writer].push_back(i);
    std::vector<RawSample> ordered(samples.size());
    for (const auto& [writer, at] : places) {
      std::vector<std::size_t> by_number = at;
      std::sort(by_number.begin(), by_number.end(), [&](std::size_t a, std::size_t b) {
        return samples[a].sequence < samples[b].sequence;
      });
      for (std::size_t i = 0; i < at.size(); ++i) ordered[at[i]] = std::move(samples[by_number[i]]);
    }
    return ordered;
  }

  void count(const RawSample& sample) {
    ++received;
    Seen& seen = writers_[sample.writer];
    // What a writer kept from before has gaps that are no losses, but never more samples of an
    // instance than it keeps: the next one of it was written since.
    if (!seen.live && (kept_ == 0 || ++seen.kept[sample.instance] > kept_)) {
      seen.live = true;
      seen.kept.clear();
    }
    if (seen.live && seen.sequence > 0 && sample.sequence > seen.sequence + 1)
      lost += sample.sequence - seen.sequence - 1;
    seen.sequence = std::max(seen.sequence, sample.sequence);
  }

  void forget(const Guid& writer) {
    writers_.erase(writer);
    std::erase_if(disposed_, [&](const auto& ended) { return ended.second == writer; });
  }

  Take take_;
  KeyOf key_;
  std::set<Guid> instances_;  // that have been seen, where we find the keys
  std::mutex mutex_;
  int kept_;
  std::map<Guid, Seen> writers_;
  std::set<std::pair<Guid, Guid>> disposed_;  // instance and writer, until its next change
  std::deque<Guid> ended_;                    // last instances that have, in order
};

RawReader::RawReader(std::unique_ptr<Listener> listener, fdds::Subscriber* subscriber,
                     fdds::DataReader* reader)
    : listener_(std::move(listener)), subscriber_(subscriber), reader_(reader) {}

RawReader::~RawReader() {
  reader_->set_listener(nullptr);
  subscriber_->delete_datareader(reader_);
}

Expected<std::unique_ptr<RawReader>> RawReader::create(Participant& participant,
                                                       const RawTopic& topic, Take take,
                                                       KeyOf key) {
  auto listener = std::make_unique<Listener>(
      std::move(take), key, topic.qos.transient_local ? topic.qos.writer_depth : 0);
  TopicQos qos = topic.qos;
  qos.reader_depth = 0;
  qos.deadline = {};  // nobody waits here
  const bool ask_for_keys = topic.keyed && !key;
  auto made = participant.make_reader(
      topic.name, qos, fdds::TypeSupport(new RawType(topic.type, topic.keyed, std::move(key))),
      listener.get(), true, ask_for_keys);
  if (!made) return tl::unexpected(made.error());
  return std::unique_ptr<RawReader>(
      new RawReader(std::move(listener), participant.subscriber(), *made));
}

std::uint64_t RawReader::lost() const {
  return listener_->lost;
}
std::uint64_t RawReader::received() const {
  return listener_->received;
}
std::size_t RawReader::writers() const {
  return listener_->writers();
}

Expected<RawWriter> RawWriter::create(Participant& participant, const RawTopic& topic) {
  auto made = participant.make_writer(
      topic.name, topic.qos, fdds::TypeSupport(new RawType(topic.type, topic.keyed)), true);
  if (!made) return tl::unexpected(made.error());
  return RawWriter(*made);
}

std::size_t RawWriter::readers() const {
  fdds::PublicationMatchedStatus status;
  return succeeded(writer_->get_publication_matched_status(status))
             ? static_cast<std::size_t>(status.current_count)
             : 0;
}

bool RawWriter::write(const RawSample& sample, Time sent) {
  auto* data = const_cast<RawSample*>(&sample);
  if (sample.kind == RawSample::Kind::data) {
    rtps::WriteParams parameters;
    rtps::Time_t stamp;
    stamp.from_ns(to_ns(sent));
    parameters.source_timestamp(stamp);
    return succeeded(writer_->write(data, parameters));
  }
  const DdsTime stamp(static_cast<std::int32_t>(to_ns(sent) / 1'000'000'000),
                      static_cast<std::uint32_t>(to_ns(sent) % 1'000'000'000));
  // What was written before the recording began is not known to this writer.
  const auto handle = writer_->register_instance(data);
  const auto code = sample.kind == RawSample::Kind::disposed
                        ? writer_->dispose_w_timestamp(data, handle, stamp)
                        : writer_->unregister_instance_w_timestamp(data, handle, stamp);
  return succeeded(code);
}

}  // namespace prehend::dds
