#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/dds/guard/address_book.hpp"
#include "common/dds/guard/announcement_pacer.hpp"
#include "common/dds/guard/members.hpp"
#include "common/dds/release/fastdds.hpp"

namespace prehend::dds {

/// The address in a locator of UDPv4 or TCPv4.
Ipv4 ip_of(const rtps::Locator_t& locator);

/// Judges every packet that one participant receives by UDP, in the threads that receive them.
class PacketGuard {
 public:
  using Hear = std::function<void(const Announcement&)>;
  /// serves: for a discovery server. secured: for a participant with keys. hear: told of every
  /// announcement that it lets pass, before Fast DDS is.
  /// paces: announcements go to who is there, not to a discovery server.
  explicit PacketGuard(bool serves, bool secured = false, bool paces = false, Hear hear = {});
  ~PacketGuard();
  PacketGuard(const PacketGuard&) = delete;
  PacketGuard& operator=(const PacketGuard&) = delete;
  bool accepts(std::span<const std::uint8_t> message, const Ipv4& source);
  /// Is this to be sent there now? See AnnouncementPacer.
  bool may_say(const Place& to, const void* way, const Saying& what);
  bool paces() const { return paces_; }
  void add_own(const GuidPrefix& own);
  void add_server(const GuidPrefix& server, const Ipv4& address);

  /// What was kept and counts by now: see Members.
  std::vector<std::vector<std::uint8_t>> take_departures();
  /// What became of a peer: see Members.
  void let_in(const GuidPrefix& peer);
  void lost(const GuidPrefix& peer);
  bool shook_hands(const GuidPrefix& peer) const;
  bool is_stranded() const;

 private:
  PacketVerdict judge(std::span<const std::uint8_t> message, const Ipv4& source,
                      std::vector<Announcement>& told);
  void hear(std::span<const std::uint8_t> message, const std::vector<Announcement>& told);

  mutable std::mutex mutex_;
  AddressBook book_;
  Members members_;
  Hear hear_;
  bool paces_;
  std::mutex pacing_;  // not mutex_: who sends does not wait for who receives
  AnnouncementPacer pacer_;
};

/// A participant of this process has lost a peer that it meets again only when it joins anew.
bool anybody_stranded();

/// The same transport, of UDPv4, with a guard before it, which must outlive it. Fast DDS 2.9.1 does
/// not tell the source of what comes over TCP, so that is not guarded.
std::shared_ptr<transport::TransportDescriptorInterface> guarded(
    std::shared_ptr<transport::TransportDescriptorInterface> transport, PacketGuard& guard);

/// Packets of this process that were dropped for one reason.
struct Dropped {
  PacketVerdict reason{};
  std::uint64_t count = 0;
  std::string last_source;  // "10.0.0.7"
};
std::vector<Dropped> dropped_packets();

}  // namespace prehend::dds
