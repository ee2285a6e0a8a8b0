#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/dds/discovery_events.hpp"
#include "services/console/core/protocol.hpp"

namespace prehend::console {

/// Who writes and reads which topic of a rig, as discovery tells. Safe from every thread.
class Graph : public dds::DiscoveryEvents {
 public:
  explicit Graph(std::string rig) : rig_(std::move(rig)) {}
  void on_participant(const dds::FoundParticipant& found) override;
  void on_endpoint(const dds::FoundEndpoint& found) override;
  /// Nothing: it is as it was at the last call.
  std::optional<std::vector<TopicEnds>> changed();

 private:
  struct End {
    std::string topic;
    bool writes = false;
  };
  const std::string rig_;
  std::mutex mutex_;  // guards what follows
  std::map<dds::GuidPrefix, std::string> names_;
  std::map<dds::rtps::GUID_t, End> ends_;
  bool changed_ = true;
};

}  // namespace prehend::console
