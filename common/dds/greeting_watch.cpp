#include "common/dds/greeting_watch.hpp"

#include <utility>

namespace prehend::dds {

std::vector<int> GreetingWatch::judge(const std::vector<Connection>& open, Time now) {
  std::vector<int> cut;
  std::map<int, Seen> still;
  for (const Connection& one : open) {
    Seen seen{one, now, now};
    const auto before = seen_.find(one.file);
    // A file's number is given to another connection when the first one is closed.
    if (before != seen_.end() && before->second.connection.address == one.address &&
        before->second.connection.port == one.port) {
      seen.first = before->second.first;
      if (before->second.connection.received == one.received) seen.changed = before->second.changed;
    }
    const bool greets = one.received < max_greeting;
    if (greets && (now - seen.changed > patience_with(one.address, now) ||
                   now - seen.first > max_greeting_time)) {
      cut.push_back(one.file);
      note_cut(one.address, now);
    } else {
      still.emplace(one.file, seen);
    }
  }
  seen_ = std::move(still);
  return cut;
}

Duration GreetingWatch::patience_with(const Ipv4& address, Time now) const {
  const auto known = cuts_.find(address);
  const bool often =
      known != cuts_.end() && known->second.count >= max_cuts && now - known->second.last <= memory;
  return often ? short_patience : patience;
}

void GreetingWatch::note_cut(const Ipv4& address, Time now) {
  if (cuts_.size() >= max_addresses)
    std::erase_if(cuts_, [&](const auto& entry) { return now - entry.second.last > memory; });
  if (cuts_.size() >= max_addresses) cuts_.clear();
  Cuts& cuts = cuts_[address];
  cuts.count = now - cuts.last > memory ? 1 : cuts.count + 1;
  cuts.last = now;
}

}  // namespace prehend::dds
