#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string_view>
#include <vector>

#include "common/dds/guard/admission.hpp"
#include "common/dds/guard/packet.hpp"

namespace prehend::dds {

/// What becomes of a packet: it is passed on, or why it is not.
enum class PacketVerdict : std::uint8_t {
  pass,
  malformed,
  unannounced,
  elsewhere,
  in_other_name,
  too_many,
  not_encrypted,
  contradicts,
  forged_departure,
  endless,
  kept
};
/// The reasons, as a status gives them.
inline constexpr std::array<std::string_view, 11> verdict_names{
    "",
    "malformed packet",
    "packet of nobody who was announced",
    "packet from another address than its participant's",
    "packet in the name of another participant",
    "announcement of one participant too many",
    "packet that its participant would encrypt",
    "announcement that contradicts an earlier one",
    "departure of a participant that is still there",
    "announcement that would hold for too long",
    ""};

/// Which participant speaks from which addresses. In a lab without keys anybody on the network can
/// write any participant's identity into a packet, and a middleware believes it. Here a
/// participant's addresses are the one that its first announcement came from and those that it
/// announces; nobody else speaks for it. What that leaves open: a source address can be forged on
/// the same network, programs on one host are not told apart, and who announces itself takes part.
///
/// An entry stays until its participant leaves, or until there is need of room and it has been
/// silent for longer than its lease. An announcement from a new address counts when the participant
/// has been silent for longer than its lease. All is bounded; in a lab with keys, those who were
/// let in keep their room. Pure: times and addresses are told.
class AddressBook {
 public:
  /// serves: this is a discovery server, linked servers tell it of their clients.
  /// secured: handshakes tell who is let in.
  explicit AddressBook(bool serves = false, bool secured = false)
      : serves_(serves), secured_(secured) {}

  /// source: where it came from, 127.x.x.x for all of this host's own addresses; nothing where the
  /// transport does not tell, then addresses are not compared.
  /// told: where what a message announces goes that passes.
  PacketVerdict judge(std::span<const std::uint8_t> message, std::optional<Ipv4> source, Time now,
                      std::vector<Announcement>* told = nullptr);

  /// The participant that asks speaks from this host for ever.
  void add_own(const GuidPrefix& own);
  /// A discovery server is to be found there. It may tell of others than itself.
  void add_server(const GuidPrefix& server, const Ipv4& address);
  /// It has keys of the lab.
  void let_in(const GuidPrefix& peer);

  std::size_t size() const { return entries_.size(); }
  static constexpr std::size_t max_participants = 4096;
  static constexpr std::size_t max_of_one = 256;  // that first spoke from one other host
  static constexpr std::size_t max_here = 1024;   // programs of this host
  static constexpr std::size_t max_addresses = 16;
  static constexpr Duration max_lease = std::chrono::minutes(10),
                            max_lease_secured = std::chrono::seconds(100);

 private:
  struct Entry {
    std::vector<Ipv4> addresses;
    std::optional<Ipv4> origin;  // of the first announcement, unless somebody else told of it
    Duration lease{};
    Time heard{}, admitted{};
    bool is_in = false;
    bool speaks_from(const std::optional<Ipv4>& source) const;
    bool silent(Time now) const { return now - heard > lease; }
    void add(const Ipv4& address);
    void update(const Announcement& said, Time now);
  };
  bool tells_of_others(const GuidPrefix& sender) const;
  /// False: there is none, for a participant that speaks from there.
  bool make_room(const std::optional<Ipv4>& origin, Time now);

  bool is_crowded(const std::optional<Ipv4>& origin) const;

  bool serves_, secured_;
  Admission admission_;
  std::set<GuidPrefix> servers_;
  std::map<GuidPrefix, Entry> entries_;
};

}  // namespace prehend::dds
