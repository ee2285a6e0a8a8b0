#include "common/dds/guard/address_book.hpp"

#include <algorithm>

namespace prehend::dds {
namespace {

constexpr Ipv4 here{127, 0, 0, 1};
constexpr Duration handshake = std::chrono::seconds(5);
constexpr Duration still_on_its_way = std::chrono::seconds(10);  // of one that has left
bool is_here(const Ipv4& address) {
  return address[0] == here[0];
}

}  // namespace

bool AddressBook::Entry::speaks_from(const std::optional<Ipv4>& source) const {
  return !source || is_here(*source) ||
         std::find(addresses.begin(), addresses.end(), *source) != addresses.end();
}

void AddressBook::Entry::add(const Ipv4& address) {
  if (addresses.size() < max_addresses && !speaks_from(address)) addresses.push_back(address);
}

void AddressBook::Entry::update(const Announcement& said, Time now) {
  for (const Ipv4& address : said.addresses) add(address);
  if (lease != Duration::max()) lease = said.leaves ? Duration::zero() : said.lease;
  heard = now;
}

PacketVerdict AddressBook::judge(std::span<const std::uint8_t> message, std::optional<Ipv4> source,
                                 Time now, std::vector<Announcement>* told) {
  auto packet = read_packet(message);
  if (!packet) return PacketVerdict::malformed;
  if (packet->for_others && !tells_of_others(packet->sender)) return PacketVerdict::in_other_name;
  const auto& all = packet->announcements;
  const auto own = std::find_if(all.begin(), all.end(), [&](const Announcement& one) {
    return one.participant == packet->sender;
  });
  if (own != all.end() && own->lease > (secured_ ? max_lease_secured : max_lease))
    return PacketVerdict::endless;
  auto found = entries_.find(packet->sender);
  if (found == entries_.end()) {
    if (own == all.end() || own->leaves) return PacketVerdict::unannounced;
    const bool has_quota = source && !is_here(*source);
    if ((secured_ || !has_quota) && !admission_.admits(packet->sender, now))
      return PacketVerdict::too_many;
    if (!make_room(source, now)) return PacketVerdict::too_many;
    found = entries_.try_emplace(packet->sender).first;
    found->second.origin = source;
    found->second.admitted = now;
  } else if (!found->second.speaks_from(source) &&
             (own == all.end() || !found->second.silent(now))) {
    return PacketVerdict::elsewhere;
  }
  if (source) found->second.add(*source);
  found->second.heard = now;
  if (own != all.end()) found->second.update(*own, now);
  for (const Announcement& other : all) {
    if (other.participant == packet->sender) continue;
    auto known = entries_.find(other.participant);
    if (known == entries_.end()) {
      if (other.leaves || !make_room(std::nullopt, now)) continue;
      known = entries_.try_emplace(other.participant).first;
    }
    known->second.update(other, now);
  }
  if (told) *told = std::move(packet->announcements);
  return PacketVerdict::pass;
}

void AddressBook::add_own(const GuidPrefix& own) {
  entries_[own].lease = Duration::max();
}

void AddressBook::add_server(const GuidPrefix& server, const Ipv4& address) {
  servers_.insert(server);
  entries_[server].add(address);
}

void AddressBook::let_in(const GuidPrefix& peer) {
  if (const auto found = entries_.find(peer); found != entries_.end()) found->second.is_in = true;
}

bool AddressBook::tells_of_others(const GuidPrefix& sender) const {
  return servers_.contains(sender) || (serves_ && is_server(sender));
}

bool AddressBook::make_room(const std::optional<Ipv4>& origin, Time now) {
  std::erase_if(entries_, [&](const auto& entry) {
    return entry.second.lease == Duration::zero() && now - entry.second.heard > still_on_its_way &&
           !servers_.contains(entry.first);
  });
  if (!is_crowded(origin)) return true;
  std::erase_if(entries_, [&](const auto& entry) {
    return entry.second.silent(now) && !servers_.contains(entry.first);
  });
  if (!secured_ || !is_crowded(origin)) return !is_crowded(origin);
  // Whoever has keys has been let in by now.
  std::erase_if(entries_, [&](const auto& entry) {
    return !entry.second.is_in && entry.second.lease != Duration::max() &&
           now - entry.second.admitted > handshake;
  });
  return !is_crowded(origin);
}

/// Is there no room for one more from there? Those who were let in take none of it.
bool AddressBook::is_crowded(const std::optional<Ipv4>& origin) const {
  if (entries_.size() >= max_participants) return true;
  if (!origin) return false;
  const auto of_one = std::count_if(entries_.begin(), entries_.end(), [&](const auto& entry) {
    return entry.second.origin == origin && !entry.second.is_in;
  });
  return static_cast<std::size_t>(of_one) >= (is_here(*origin) ? max_here : max_of_one);
}

}  // namespace prehend::dds
