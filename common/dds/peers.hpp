#pragma once

#include <chrono>
#include <condition_variable>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "common/dds/fastdds.hpp"

namespace prehend::dds {

class PacketGuard;

/// Hears of every peer before anybody else does: keeps count of those that are refused, and knows
/// whose handshake is under way.
class Peers : public eprosima::fastdds::dds::DomainParticipantListener {
 public:
  using DomainParticipant = eprosima::fastdds::dds::DomainParticipant;
  using Guid = rtps::GUID_t;

  /// next: told of everything as well, or nullptr. authority: of our own keys; nothing: we have
  /// none. guard: told who is let in and who is lost.
  Peers(DomainParticipantListener* next, std::optional<std::string> authority, PacketGuard& guard)
      : next_(next), authority_(std::move(authority)), guard_(guard) {}

  /// With the reason, and how often; at most 32 different ones.
  std::map<std::string, std::uint64_t> refused() const;

  /// Waits until nobody new has come for a moment and all handshakes have ended. A handshake of
  /// Fast DDS 2.9.1 sometimes never does when several processes join at once, and then the two
  /// stay strangers for good: such a peer. Of two that wait for each other the one with
  /// the greater identity gives up sooner.
  struct Undecided {
    Guid guid;
    std::string name;
  };
  std::optional<Undecided> wait_until_decided(const Guid& own) const;

  void on_participant_discovery(DomainParticipant* participant,
                                rtps::ParticipantDiscoveryInfo&& found) override;
  void onParticipantAuthentication(DomainParticipant* participant,
                                   rtps::ParticipantAuthenticationInfo&& info) override;
  void on_publisher_discovery(DomainParticipant* participant,
                              rtps::WriterDiscoveryInfo&& info) override;
  void on_subscriber_discovery(DomainParticipant* participant,
                               rtps::ReaderDiscoveryInfo&& info) override;

 private:
  using Clock = std::chrono::steady_clock;
  struct Peer {
    std::string name, authority;
    bool secured = false;
    bool decided = false;
    Clock::time_point met = Clock::now();
  };

  bool is_flooded() const;
  void meet(const rtps::ParticipantProxyData& info);
  void decide(const Guid& guid, bool let_in);
  void refuse(const Peer& peer);
  void note(const std::string& whom);

  DomainParticipantListener* next_;
  std::optional<std::string> authority_;
  PacketGuard& guard_;
  mutable std::mutex mutex_;  // guards what follows
  mutable std::condition_variable news_;
  Clock::time_point newest_{};  // when somebody came last
  std::map<Guid, Peer> peers_;
  std::map<std::string, std::uint64_t> refused_;
};

}  // namespace prehend::dds
