#include "services/console/service/graph.hpp"

#include <algorithm>
#include <utility>

namespace prehend::console {

void Graph::on_participant(const dds::FoundParticipant& found) {
  const std::scoped_lock lock(mutex_);
  if (found.news == dds::News::gone)
    names_.erase(dds::prefix_of(found.guid.guidPrefix));
  else
    names_[dds::prefix_of(found.guid.guidPrefix)] = found.name;
  changed_ = true;
}

void Graph::on_endpoint(const dds::FoundEndpoint& found) {
  const bool ours =
      rig_.empty() ? found.rigs.empty() : std::ranges::find(found.rigs, rig_) != found.rigs.end();
  const std::scoped_lock lock(mutex_);
  if (found.news == dds::News::gone || !ours)
    ends_.erase(found.guid);
  else
    ends_[found.guid] = {found.topic, found.writes};
  changed_ = true;
}

std::optional<std::vector<TopicEnds>> Graph::changed() {
  const std::scoped_lock lock(mutex_);
  if (!std::exchange(changed_, false)) return std::nullopt;
  std::map<std::string, TopicEnds> topics;
  for (const auto& [guid, end] : ends_) {
    TopicEnds& topic = topics[end.topic];
    topic.topic = end.topic;
    const auto name = names_.find(dds::prefix_of(guid.guidPrefix));
    (end.writes ? topic.writers : topic.readers)
        .push_back(name == names_.end() ? "unknown" : name->second);
  }
  std::vector<TopicEnds> all;
  for (auto& [name, topic] : topics) all.push_back(std::move(topic));
  return all;
}

}  // namespace prehend::console
