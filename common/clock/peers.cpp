#include "common/clock/peers.hpp"

#include <algorithm>
#include <utility>

namespace prehend::clock {
namespace {

constexpr std::size_t max_peers = 256;                 // more than a rig has services
constexpr std::size_t max_told = 64;                   // idl/Operation.idl
constexpr Duration memory = std::chrono::seconds(10);  // of who says nothing any more
constexpr std::size_t process_bytes = 8;               // of a Participant
constexpr std::size_t max_sent = 128;                  // they come at 50 Hz at most, mostly at 1 Hz

}  // namespace

Peers::Peers(std::string service, std::string host)
    : service_(std::move(service)), host_(std::move(host)) {}

Peers::Heard Peers::hear(const v1::ClockBeacon& beacon, const Participant& from, Time received) {
  forget(received);
  const std::string service = beacon.service().to_string();
  if (service == service_) return {};
  const std::pair key(service, from);
  if (!peers_.contains(key) && peers_.size() >= max_peers) return {};
  Peer& peer = peers_[key];
  const Time sent = from_ns(beacon.stamp_ns());
  peer.step = Duration(beacon.step_ns());
  Heard heard{.answer = true};
  for (const v1::ClockPeer& told : beacon.peers()) {
    if (told.service().to_string() != service_) continue;
    // Of somebody else who claims our name.
    if (std::find(sent_.begin(), sent_.end(), told.sent_ns()) == sent_.end()) continue;
    heard.answer = !told.known();
    const auto before = peer.filter.at(received);
    const std::uint64_t steps = peer.filter.steps();
    peer.filter.add({from_ns(told.sent_ns()), from_ns(told.received_ns()), sent, received});
    if (peer.filter.steps() > steps) heard.step = peer.filter.at(received)->offset - before->offset;
  }
  peer.sent = sent;
  peer.received = received;
  return heard;
}

v1::ClockBeacon Peers::beacon(Time now, Duration step) {
  forget(now);
  v1::ClockBeacon beacon;
  beacon.service(service_.c_str());
  beacon.host(host_.c_str());
  beacon.stamp_ns(to_ns(now));
  beacon.step_ns(step.count());
  sent_.push_back(beacon.stamp_ns());
  if (sent_.size() > max_sent) sent_.pop_front();
  for (const auto& [key, peer] : peers_) {
    if (beacon.peers().size() == max_told) break;
    v1::ClockPeer told;
    told.service(key.first.c_str());
    told.sent_ns(to_ns(peer.sent));
    told.received_ns(to_ns(peer.received));
    if (const auto offset = peer.filter.at(now)) {
      told.known(true);
      told.offset_ns(offset->offset.count());
      told.uncertainty_ns(offset->uncertainty.count());
    }
    beacon.peers().push_back(told);
  }
  return beacon;
}

Duration Peers::ahead(const Participant& writer, Time now) const {
  const Peer* peer = find_measured(writer);
  const auto offset = peer ? peer->filter.at(now) : std::nullopt;
  return offset && std::chrono::abs(offset->offset) > offset->uncertainty ? offset->offset
                                                                          : Duration::zero();
}

Duration Peers::system_ahead(const Participant& writer, Time now) const {
  const Peer* peer = find_measured(writer);
  return ahead(writer, now) + (peer ? peer->step : Duration::zero());
}

std::optional<Offset> Peers::offset(const std::string& service, Time now) const {
  std::optional<Offset> best;
  for (const auto& [key, peer] : peers_) {
    if (key.first != service) continue;
    const auto known = peer.filter.at(now);
    if (known && (!best || known->uncertainty < best->uncertainty)) best = known;
  }
  return best;
}

/// The participant itself, else another one of its process: the replayer plays through its own.
template <class Wanted>
const Peers::Entry* Peers::find(const Participant& writer, Wanted wanted) const {
  const Entry* same_process = nullptr;
  for (const Entry& entry : peers_) {
    const Participant& participant = entry.first.second;
    if (!wanted(entry.second)) continue;
    if (participant == writer) return &entry;
    if (std::equal(writer.begin(), writer.begin() + process_bytes, participant.begin()))
      same_process = &entry;
  }
  return same_process;
}

const Peers::Peer* Peers::find_measured(const Participant& writer) const {
  const Entry* entry =
      find(writer, [](const Peer& peer) { return peer.filter.at(peer.received).has_value(); });
  return entry ? &entry->second : nullptr;
}

std::string Peers::service_of(const Participant& writer) const {
  const Entry* entry = find(writer, [](const Peer&) { return true; });
  return entry ? entry->first.first : std::string();
}

void Peers::forget(Time now) {
  std::erase_if(peers_, [&](const auto& entry) { return now - entry.second.received > memory; });
}

}  // namespace prehend::clock
