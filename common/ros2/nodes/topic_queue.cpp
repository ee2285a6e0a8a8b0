#include "common/ros2/nodes/topic_queue.hpp"

#include <utility>

namespace prehend::ros2 {

Expected<std::unique_ptr<TopicQueue>> TopicQueue::create(dds::Participant& participant,
                                                         const dds::RawTopic& topic,
                                                         std::size_t kept) {
  std::unique_ptr<TopicQueue> made(new TopicQueue(kept));
  auto reader = dds::RawReader::create(
      participant, topic,
      [queue = made.get()](dds::RawSample&& sample) { queue->keep(std::move(sample)); });
  if (!reader) return tl::unexpected(reader.error());
  made->reader_ = std::move(*reader);
  return made;
}

TopicQueue::~TopicQueue() = default;

void TopicQueue::keep(dds::RawSample&& sample) {
  if (sample.kind != dds::RawSample::Kind::data) return;
  const std::scoped_lock lock(mutex_);
  if (heard_.size() == kept_) heard_.pop_front();
  heard_.push_back(std::move(sample));
  come_.notify_one();
}

std::optional<dds::RawSample> TopicQueue::next(Duration timeout) {
  std::unique_lock lock(mutex_);
  if (!come_.wait_for(lock, timeout, [this] { return !heard_.empty(); })) return std::nullopt;
  dds::RawSample first = std::move(heard_.front());
  heard_.pop_front();
  return first;
}

}  // namespace prehend::ros2
