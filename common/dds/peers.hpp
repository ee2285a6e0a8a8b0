#pragma once

#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "common/dds/discovery_events.hpp"
#include "common/dds/guard/packet.hpp"

namespace prehend::dds {

class PacketGuard;

/// Hears of every peer before anybody else does: keeps count of those that are refused, and knows
/// whose handshake is under way.
class Peers : public DiscoveryEvents {
 public:
  /// next: told of everything as well, or nullptr. authority: of our own keys; nothing: we have
  /// none. guard: told who is let in and who is lost.
  Peers(DiscoveryEvents* next, std::optional<std::string> authority, PacketGuard& guard)
      : next_(next), authority_(std::move(authority)), guard_(guard) {}

  /// A peer as it presents itself: «mapping», «Fast DDS 3.1.2».
  struct Presented {
    std::string name, middleware;
    std::optional<Role> role;    // as role_of() has it
    std::set<std::string> rigs;  // of its endpoints, as far as we heard of any
  };
  std::map<GuidPrefix, Presented> present() const;
  /// The role of a peer: in a secured lab that of its certificate, otherwise what it announces.
  /// Nothing: the peer is not known, or has no role of ours.
  std::optional<Role> role_of(const GuidPrefix& whose) const;
  /// Peers that were refused, or that refuse us: with the reason, and how often. At most 32
  /// different ones.
  std::map<std::string, std::uint64_t> refused() const;

  /// A peer whose handshake with us does not end. When several processes join at once, a handshake
  /// of Fast DDS 2.9.1 sometimes never ends, and the two stay strangers for good.
  struct Undecided {
    Guid guid;
    std::string name;
  };
  /// Waits until nobody new has come for a moment and all handshakes have ended. Returns a peer
  /// whose handshake has taken too long. Two peers that wait for each other do not give up at the
  /// same time: the one with the greater identity does so sooner.
  std::optional<Undecided> wait_until_decided(const Guid& own) const;

  /// Of the packet guard: what a peer says before Fast DDS is told. Of Fast DDS 3 we hear of a
  /// secured peer only after it has been let in or refused, and never whose keys it has.
  void hear(const Announcement& said);
  void on_participant(const FoundParticipant& found) override;
  void on_endpoint(const FoundEndpoint& found) override;
  void on_judged(const Guid& guid, bool let_in) override;

 private:
  using Clock = std::chrono::steady_clock;
  struct Peer {
    std::string name, authority, middleware, certificate;
    std::optional<Role> role;  // as it announces it
    bool secured = false;
    bool decided = false;
    Clock::time_point met = Clock::now();
    std::set<std::string> rigs;

    /// Over TCP nobody is told of the certificates of Fast DDS 3.
    std::optional<Role> is() const {
      return certificate.empty() ? role : role_of_certificate(certificate);
    }
  };

  bool is_flooded() const;
  void meet(const FoundParticipant& found);
  void refuse(const Peer& peer);
  bool of_other_release(const Peer& peer) const;
  void note(const std::string& whom);

  DiscoveryEvents* next_;
  std::optional<std::string> authority_;
  PacketGuard& guard_;
  mutable std::mutex mutex_;  // guards what follows
  mutable std::condition_variable news_;
  Clock::time_point newest_{};  // when somebody came last
  std::map<Guid, Peer> peers_;
  std::map<std::string, std::uint64_t> refused_;
};

}  // namespace prehend::dds
