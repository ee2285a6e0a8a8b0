#include "common/dds/peers.hpp"

#include <algorithm>

#include "common/dds/guarded_transport.hpp"

namespace prehend::dds {

using std::chrono::milliseconds;

namespace {

// Peers that are there answer the first announcement within this time.
constexpr milliseconds quiet{400};
// A handshake takes some 100 ms, and a lost message of it is sent again after 500 ms.
constexpr milliseconds patience{1500}, longer_patience{3000};
constexpr std::size_t max_peers = 1024, max_reasons = 32;
// So many that only announce themselves and never shake hands are no lab that starts: nobody waits
// for them.
constexpr int max_mute = 16;

GuidPrefix prefix_of(const rtps::GUID_t& guid) {
  GuidPrefix prefix;
  std::copy_n(guid.guidPrefix.value, prefix.size(), prefix.begin());
  return prefix;
}

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
    const bool flooded = is_flooded();
    auto until = (flooded ? begin + quiet : std::max(begin, newest_)) + quiet;
    bool all = true;
    for (const auto& [guid, peer] : peers_) {
      if (peer.decided || (flooded && !guard_.shook_hands(prefix_of(guid)))) continue;
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
  return std::count_if(peers_.begin(), peers_.end(), [this](const auto& entry) {
           return !entry.second.decided && !guard_.shook_hands(prefix_of(entry.first));
         }) > max_mute;
}

void Peers::on_participant_discovery(DomainParticipant* participant,
                                     rtps::ParticipantDiscoveryInfo&& found) {
  using Found = rtps::ParticipantDiscoveryInfo;
  if (found.status == Found::DISCOVERED_PARTICIPANT) {
    meet(found.info);
  } else if (found.status != Found::CHANGED_QOS_PARTICIPANT) {
    guard_.lost(prefix_of(found.info.m_guid));
    const std::scoped_lock lock(mutex_);
    peers_.erase(found.info.m_guid);
    news_.notify_all();
  }
  if (next_) next_->on_participant_discovery(participant, std::move(found));
}

void Peers::onParticipantAuthentication(DomainParticipant* participant,
                                        rtps::ParticipantAuthenticationInfo&& info) {
  const bool in = info.status == rtps::ParticipantAuthenticationInfo::AUTHORIZED_PARTICIPANT;
  if (in) guard_.let_in(prefix_of(info.guid));
  decide(info.guid, in);
  if (next_) next_->onParticipantAuthentication(participant, std::move(info));
}

void Peers::on_publisher_discovery(DomainParticipant* participant,
                                   rtps::WriterDiscoveryInfo&& info) {
  if (next_) next_->on_publisher_discovery(participant, std::move(info));
}

void Peers::on_subscriber_discovery(DomainParticipant* participant,
                                    rtps::ReaderDiscoveryInfo&& info) {
  if (next_) next_->on_subscriber_discovery(participant, std::move(info));
}

void Peers::meet(const rtps::ParticipantProxyData& info) {
  Peer peer;
  peer.name = info.m_participantName.to_string();
  for (const rtps::Property& property : info.identity_token_.properties()) {
    peer.secured = true;
    if (property.name() == "dds.ca.sn") peer.authority = property.value();
  }
  const std::scoped_lock lock(mutex_);
  if (peer.secured && !authority_) note(peer.name + ", which is secured while this process is not");
  // Only who is to be judged, and not without bound.
  if (!authority_ || peers_.size() >= max_peers) return;
  peer.decided = !peer.secured;
  newest_ = peer.met;
  peers_.insert_or_assign(info.m_guid, std::move(peer));
  news_.notify_all();
}

void Peers::decide(const Guid& guid, bool let_in) {
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
