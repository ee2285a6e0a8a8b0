#include "common/dds/peers.hpp"

#include <algorithm>
#include <utility>

#include "common/dds/guard/guarded_transport.hpp"

namespace prehend::dds {

using std::chrono::milliseconds;

namespace {

// Peers that are there answer the first announcement within this time.
constexpr milliseconds quiet{400};
// A handshake takes some 100 ms, and a lost message of it is sent again after 500 ms.
// Fast DDS 3.1 goes on with it for as long as it takes, so nobody need give up sooner there.
constexpr milliseconds longer_patience{3000},
    patience = PREHEND_FAST_DDS == 2 ? milliseconds(1500) : longer_patience;
constexpr std::size_t max_peers = 1024, max_reasons = 32, max_rigs = 8;
// So many that only announce themselves and never shake hands are no lab that starts: nobody waits
// for them.
constexpr int max_mute = 16;

}  // namespace

std::map<GuidPrefix, Peers::Presented> Peers::present() const {
  const std::scoped_lock lock(mutex_);
  std::map<GuidPrefix, Presented> all;
  for (const auto& [guid, peer] : peers_)
    all.emplace(prefix_of(guid.guidPrefix),
                Presented{peer.name, peer.middleware, peer.is(), peer.rigs});
  return all;
}

std::optional<Role> Peers::role_of(const GuidPrefix& whose) const {
  Guid guid;
  std::ranges::copy(whose, guid.guidPrefix.value);
  guid.entityId = rtps::c_EntityId_RTPSParticipant;
  const std::scoped_lock lock(mutex_);
  const auto found = peers_.find(guid);
  return found == peers_.end() ? std::nullopt : found->second.is();
}

std::map<std::string, std::uint64_t> Peers::refused() const {
  const std::scoped_lock lock(mutex_);
  return refused_;
}

std::optional<Peers::Undecided> Peers::wait_until_decided(const Guid& own) const {
  std::unique_lock lock(mutex_);
  const auto begin = Clock::now();
  while (true) {
    const auto now = Clock::now();
    const bool flooded = is_flooded();
    auto until = (flooded ? begin + quiet : std::max(begin, newest_)) + quiet;
    bool all = true;
    for (const auto& [guid, peer] : peers_) {
      if (peer.decided || guid == own) continue;
      if (flooded && !guard_.shook_hands(prefix_of(guid.guidPrefix))) continue;
      const auto end = peer.met + (guid < own && !flooded ? patience : longer_patience);
      if (now >= end) return Undecided{guid, peer.name};
      until = all ? end : std::min(until, end);
      all = false;
    }
    if (all && now >= until) return std::nullopt;
    news_.wait_until(lock, until);
  }
}

bool Peers::is_flooded() const {
  return std::ranges::count_if(peers_, [this](const auto& entry) {
           return !entry.second.decided && !guard_.shook_hands(prefix_of(entry.first.guidPrefix));
         }) > max_mute;
}

void Peers::hear(const Announcement& said) {
  Guid guid;
  std::ranges::copy(said.participant, guid.guidPrefix.value);
  guid.entityId = rtps::c_EntityId_RTPSParticipant;
  const std::scoped_lock lock(mutex_);
  const auto known = peers_.find(guid);
  if (!said.leaves && known == peers_.end()) {
    meet({News::found, guid, said.name, said.middleware, said.role, said.secured, said.authority,
          said.certificate});
  } else if (said.leaves && known != peers_.end() && !known->second.decided) {
    // Of the others Fast DDS knows whether it is true.
    peers_.erase(known);
    news_.notify_all();
  }
}

void Peers::on_participant(const FoundParticipant& found) {
  if (found.news == News::gone) guard_.lost(prefix_of(found.guid.guidPrefix));
  if (found.news != News::changed) {
    const std::scoped_lock lock(mutex_);
    const auto known = peers_.find(found.guid);
    if (found.news == News::gone) {
      peers_.erase(found.guid);
      news_.notify_all();
    } else if (known == peers_.end()) {
      meet(found);
    } else {  // heard of, or judged, before
      known->second.name = found.name;
      known->second.middleware = found.middleware;
      known->second.role = found.role;
    }
  }
  if (next_) next_->on_participant(found);
}

void Peers::on_endpoint(const FoundEndpoint& found) {
  if (found.news == News::found) {
    Guid whose = found.guid;
    whose.entityId = rtps::c_EntityId_RTPSParticipant;
    const std::scoped_lock lock(mutex_);
    if (const auto peer = peers_.find(whose); peer != peers_.end())
      for (const std::string& rig : found.rigs)
        if (peer->second.rigs.size() < max_rigs) peer->second.rigs.insert(rig);
  }
  if (next_) next_->on_endpoint(found);
}

void Peers::meet(const FoundParticipant& found) {
  Peer peer{found.name,        found.authority, found.middleware,
            found.certificate, found.role,      found.secured};
  if (peer.secured && !authority_) note(peer.name + ", which is secured while this process is not");
  // Not without bound.
  if (peers_.size() >= max_peers) return;
  // Only who has keys is judged where there are keys. The releases of Fast DDS do not let each
  // other in, and their handshake would never end.
  const bool stranger = authority_ && peer.secured && of_other_release(peer);
  if (stranger) refuse(peer);
  peer.decided = !authority_ || !peer.secured || stranger;
  if (authority_) newest_ = peer.met;
  peers_.insert_or_assign(found.guid, std::move(peer));
  news_.notify_all();
}

void Peers::on_judged(const Guid& guid, bool let_in) {
  if (let_in) guard_.let_in(prefix_of(guid.guidPrefix));
  const std::scoped_lock lock(mutex_);
  const auto found = peers_.find(guid);
  if (found == peers_.end()) {
    Peer peer{"somebody", {}, {}, {}, {}, true, true};
    if (!let_in)
      refuse(peer);
    else if (peers_.size() < max_peers)
      peers_.emplace(guid, std::move(peer));
  } else {
    // Who is of another release was refused when it came.
    if (!let_in && !of_other_release(found->second)) refuse(found->second);
    found->second.decided = true;
  }
  news_.notify_all();
}

bool Peers::of_other_release(const Peer& peer) const {
  constexpr std::size_t major = std::string_view("Fast DDS ").size();
  return peer.middleware.size() > major && peer.middleware.starts_with("Fast DDS ") &&
         peer.middleware[major] != own_middleware[major];
}

void Peers::refuse(const Peer& peer) {
  if (!peer.secured)
    note(peer.name + ", which has no keys");
  else if (of_other_release(peer))
    note(peer.name + ", which has " + peer.middleware +
         ", not " PREHEND_FAST_DDS_RELEASE ": a secured lab is all Debian 12 or all Debian 13");
  else if (peer.authority != "/" + *authority_)  // as the plugin writes it
    note(peer.name + ", whose keys are of another authority");
  else
    note(peer.name + ", whose keys are revoked or not valid");
}

void Peers::note(const std::string& whom) {
  if (refused_.size() < max_reasons || refused_.contains(whom)) ++refused_[whom];
}

}  // namespace prehend::dds
