#include "common/recording/layout/latched_samples.hpp"

#include <algorithm>

namespace prehend::recording {

recording::mcap::Message LatchedSamples::Sample::message() const {
  recording::mcap::Message message = head;
  message.data = data;
  return message;
}

void LatchedSamples::take(const Stream& stream, const recording::mcap::Message& message) {
  if (!stream.topic.qos.transient_local) return;
  auto& kept = alive_[{stream.topic.name, stream.writer, stream.instance}];
  if (stream.kind != dds::RawSample::Kind::data) {
    kept.clear();
    return;
  }
  Sample& sample = kept.emplace_back(Sample{&stream, message, {}});
  sample.data.assign(message.data.begin(), message.data.end());
  sample.head.data = {};
  const int depth = stream.topic.qos.writer_depth;
  if (depth > 0 && kept.size() > static_cast<std::size_t>(depth)) kept.pop_front();
}

std::vector<LatchedSamples::Sample> LatchedSamples::samples() const {
  std::vector<Sample> all;
  for (const auto& [instance, kept] : alive_) all.insert(all.end(), kept.begin(), kept.end());
  std::ranges::stable_sort(all, {}, [](const Sample& sample) { return sample.head.log_time; });
  return all;
}

}  // namespace prehend::recording
