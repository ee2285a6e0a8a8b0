#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "common/dds/raw.hpp"

namespace prehend::integration {

/// Instances of each topic.
inline constexpr std::uint8_t instances = 5;

/// All reliable topics of the lab, with samples that are numbered instead of its own.
inline std::vector<dds::RawTopic> numbered_topics() {
  std::vector<dds::RawTopic> all;
  for (const dds::TopicInfo& topic : dds::topic_table)
    if (topic.qos.reliable) all.push_back({std::string(topic.name), "numbered", true, topic.qos});
  return all;
}

inline dds::RawSample numbered(std::uint8_t instance, std::uint64_t number) {
  dds::RawSample sample;
  sample.payload = {0, 1, 0, 0, instance, 0, 0, 0};
  sample.payload.resize(16);
  std::memcpy(sample.payload.data() + 8, &number, sizeof number);
  sample.instance[0] = instance;
  return sample;
}

/// Instance and number.
inline std::pair<std::uint8_t, std::uint64_t> numbered(const dds::RawSample& sample) {
  std::uint64_t number = 0;
  std::memcpy(&number, sample.payload.data() + 8, sizeof number);
  return {sample.payload[4], number};
}

}  // namespace prehend::integration
