#include "services/recorder/service/topic_listener.hpp"

#include <fnmatch.h>

#include "common/base/log.hpp"
#include "common/base/log_format.hpp"

namespace prehend::recorder {

Expected<std::unique_ptr<TopicListener>> TopicListener::create(const Options& options, Take take) {
  std::unique_ptr<TopicListener> made(new TopicListener(options, std::move(take)));
  dds::ParticipantOptions lab = options.lab;
  lab.listener = &made->discovery_;
  auto participant = dds::Participant::create(lab);
  if (!participant) return tl::unexpected(participant.error());
  made->participant_.emplace(std::move(*participant));
  TopicListener* raw = made.get();
  made->thread_ = std::jthread([raw](const std::stop_token& stop) { raw->hand_on(stop); });
  return made;
}

TopicListener::TopicListener(const Options& options, Take take)
    : options_(options),
      take_(std::move(take)),
      discovery_([this](const dds::DiscoveredWriter& found) {
        if (found.gone) return;
        {
          const std::scoped_lock lock(found_mutex_);
          found_.push_back(found);
        }
        options_.on_found();
      }) {}

TopicListener::~TopicListener() {
  stop();
}

void TopicListener::stop() {
  if (!participant_) return;
  lost_at_stop_ = lost();
  for (auto& [topic, reading] : readers_) reading->reader.reset();
  participant_.reset();
  drain();
}

std::optional<std::string> TopicListener::rig_of(const dds::DiscoveredWriter& found) const {
  if (found.rigs.empty() && options_.lab.rig.empty()) return "";
  for (const std::string& rig : found.rigs)
    if (rig == options_.lab.rig || ::fnmatch(options_.lab.rig.c_str(), rig.c_str(), 0) == 0)
      return rig;
  return std::nullopt;
}

void TopicListener::poll() {
  std::vector<dds::DiscoveredWriter> found;
  {
    const std::scoped_lock lock(found_mutex_);
    found.swap(found_);
  }
  for (const dds::DiscoveredWriter& one : found)
    if (const auto rig = rig_of(one); rig && options_.topics.wants(one.topic.name)) read(one, *rig);
}

void TopicListener::read(const dds::DiscoveredWriter& found, const std::string& rig) {
  const auto known = readers_.find(found.topic.name);
  if (known != readers_.end()) {
    Reading& reading = *known->second;
    const dds::RawTopic& topic = reading.source.topic;
    const bool other = topic.type != found.topic.type || topic.keyed != found.topic.keyed;
    const bool weaker = (topic.qos.reliable && !found.topic.qos.reliable) ||
                        (topic.qos.transient_local && !found.topic.qos.transient_local) ||
                        topic.qos.exclusive_ownership != found.topic.qos.exclusive_ownership;
    if ((other || weaker) && !std::exchange(reading.complained, true))
      log::warning("{}: another writer has {}; it is not recorded", found.topic.name,
                   other ? "another type" : "a weaker QoS");
    return;
  }
  auto reading = std::make_unique<Reading>();
  reading->source = {found.topic, rig};
  Reading* raw = reading.get();
  dds::KeyOf key = options_.keys(found.topic.type);
  reading->keyless = found.topic.keyed && !key;
  auto reader = dds::RawReader::create(
      *participant_, found.topic,
      [this, raw](dds::RawSample&& sample) { queue(*raw, std::move(sample)); }, std::move(key));
  if (reader)
    reading->reader = std::move(*reader);
  else
    log::warning(reader.error());
  readers_.emplace(found.topic.name, std::move(reading));
}

void TopicListener::queue(Reading& reading, dds::RawSample&& sample) {
  if (reading.keyless && sample.instance == dds::Guid{}) {
    reading.keyless = false;
    log::warning(
        "{}: its writer sends no keys and the type {} is not known; its instances are "
        "recorded as one",
        reading.source.topic.name, reading.source.topic.type);
  }
  {
    const std::scoped_lock lock(queue_mutex_);
    const std::uint64_t size = sample.payload.size() + sizeof(Item);
    if (queue_bytes_ + size > options_.queue_bytes) {
      ++reading.overflow;
      return;
    }
    queue_bytes_ += size;
    queue_.push_back({&reading.source, std::move(sample)});
  }
  queue_news_.notify_one();
}

void TopicListener::hand_on(const std::stop_token& stop) {
  std::vector<Item> batch;
  while (true) {
    {
      std::unique_lock lock(queue_mutex_);
      handing_on_ = false;
      if (queue_.empty()) queue_empty_.notify_all();
      if (!queue_news_.wait(lock, stop, [this] { return !queue_.empty(); })) return;
      batch.swap(queue_);
      handing_on_ = true;
    }
    for (Item& item : batch) {
      const std::uint64_t size = item.sample.payload.size() + sizeof(Item);
      take_(*item.source, std::move(item.sample));
      const std::scoped_lock lock(queue_mutex_);
      queue_bytes_ -= size;
    }
    batch.clear();
  }
}

void TopicListener::drain() {
  std::unique_lock lock(queue_mutex_);
  queue_empty_.wait(lock, [this] { return queue_.empty() && !handing_on_; });
}

std::map<std::string, std::uint64_t> TopicListener::lost() const {
  if (!participant_) return lost_at_stop_;
  std::map<std::string, std::uint64_t> lost;
  const std::scoped_lock lock(queue_mutex_);
  for (const auto& [topic, reading] : readers_)
    if (reading->reader) lost[topic] = reading->reader->lost() + reading->overflow;
  return lost;
}

}  // namespace prehend::recorder
