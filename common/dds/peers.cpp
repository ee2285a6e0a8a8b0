#include "common/dds/peers.hpp"

#include <algorithm>

namespace prehend::dds {

using std::chrono::milliseconds;

namespace {

// Peers that are there answer the first announcement within this time.
constexpr milliseconds quiet{400};
// A handshake takes some 100 ms, and a lost message of it is sent again after 500 ms.
constexpr milliseconds patience{1500}, longer_patience{3000};
constexpr std::size_t max_peers = 1024, max_reasons = 32;

}  // namespace

std::map<std::string, std::uint64_t> Peers::refused() const {
  const std::scoped_lock lock(mutex_);
  return refused_;
}

std::optional<Peers::Undecided> Peers::wait_until_decided(const Guid& own) const {
  std::unique_lock lock(mutex_);
  const auto begin = Clock::now();
  while (true) {
    const auto now = Clock::now();
    auto until = std::max(begin, newest_) + quiet;
    bool all = true;
    for (const auto& [guid, peer] : peers_) {
      if (peer.decided) continue;
      const auto end = peer.met + (guid < own ? patience : longer_patience);
      if (now >= end) return Undecided{guid, peer.name};
      until = all ? end : std::min(until, end);
      all = false;
    }
    if (all && now >= until) return std::nullopt;
    news_.wait_until(lock, until);
  }
}

void Peers::on_participant(const FoundParticipant& found) {
  if (found.news == News::found) {
    meet(found);
  } else if (found.news == News::gone) {
    const std::scoped_lock lock(mutex_);
    peers_.erase(found.guid);
    news_.notify_all();
  }
  if (next_) next_->on_participant(found);
}

void Peers::on_endpoint(const FoundEndpoint& found) {
  if (next_) next_->on_endpoint(found);
}

void Peers::meet(const FoundParticipant& found) {
  Peer peer;
  peer.name = found.name;
  peer.secured = found.secured;
  peer.authority = found.authority;
  const std::scoped_lock lock(mutex_);
  if (peer.secured && !authority_) note(peer.name + ", which is secured while this process is not");
  // Only who is to be judged, and not without bound.
  if (!authority_ || peers_.size() >= max_peers) return;
  peer.decided = !peer.secured;
  newest_ = peer.met;
  peers_.insert_or_assign(found.guid, std::move(peer));
  news_.notify_all();
}

void Peers::on_judged(const Guid& guid, bool let_in) {
  const std::scoped_lock lock(mutex_);
  const auto found = peers_.find(guid);
  if (!let_in) refuse(found == peers_.end() ? Peer{"somebody", {}, true} : found->second);
  if (found != peers_.end()) found->second.decided = true;
  news_.notify_all();
}

void Peers::refuse(const Peer& peer) {
  if (!peer.secured)
    note(peer.name + ", which has no keys");
  else if (peer.authority != "/" + *authority_)  // as the plugin writes it
    note(peer.name + ", whose keys are of another authority");
  else
    note(peer.name + ", whose keys are revoked or not valid");
}

void Peers::note(const std::string& whom) {
  if (refused_.size() < max_reasons || refused_.contains(whom)) ++refused_[whom];
}

}  // namespace prehend::dds
