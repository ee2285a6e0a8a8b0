#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "common/base/time.hpp"
#include "common/dds/guard/packet.hpp"
#include "common/dds/guard/plaintext.hpp"

namespace prehend::dds {

/// Whom handshakes have let in. Discovery of participants is never encrypted, so anybody can write
/// in a member's name that it leaves, or is elsewhere: Fast DDS 2.9.1 believes that, and the two
/// then stay strangers for good. In a lab with keys a member leaves by the encrypted end of its
/// endpoints. What it says in plain text counts only when it has been silent since: Fast DDS may
/// lock itself up over a member that ends by its lease. It stays what it was when it was let in.
///
/// Without keys a departure is believed; whether it was forged shows afterwards. Pure: times are
/// told. Bounded.
class Members {
 public:
  explicit Members(bool secured) : secured_(secured) {}

  enum class Verdict : std::uint8_t { pass, keep, not_encrypted, contradicts };
  /// Of a sound message, which its sender may send. announces: it tells of participants; without
  /// keys nothing else is looked at.
  Verdict judge(const GuidPrefix& sender, std::span<const std::uint8_t> message, Time now,
                bool announces = true);
  /// Messages that were kept and count by now, each once.
  std::vector<std::vector<std::uint8_t>> take_departures(Time now);
  /// Departures since the last call of somebody who is still there.
  std::uint64_t take_forged();

  void let_in(const GuidPrefix& peer);
  /// The middleware has forgotten it.
  void lost(const GuidPrefix& peer);
  /// A member was lost, though nobody said that it leaves, and goes on announcing itself: only who
  /// joins anew meets it again.
  bool is_stranded(Time now) const;
  /// Has it sent anything of a handshake?
  bool shook_hands(const GuidPrefix& peer) const;

  std::size_t size() const { return all_.size(); }
  static constexpr std::size_t max_known = 4096;
  static constexpr std::size_t max_said = 4;  // different announcements before it was let in

 private:
  struct Member {
    bool is_in = false, is_lost = false, shook_hands = false;
    std::vector<std::vector<std::uint8_t>> said;  // announcements
    std::vector<std::uint8_t> departure;          // the last one, kept
    std::uint64_t departures = 0;                 // that nobody knows yet whether they are true
    Time departed{}, heard{};
    std::optional<Time> back, announced;  // since it was lost
  };
  Member* find_or_make(const GuidPrefix& peer, Time now);
  static bool agrees(Member& member, const Plaintext& said);

  bool secured_;
  std::uint64_t forged_ = 0;
  Time next_look_{};
  std::map<GuidPrefix, Member> all_;
};

}  // namespace prehend::dds
