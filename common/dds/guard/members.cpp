#include "common/dds/guard/members.hpp"

#include <algorithm>
#include <utility>

namespace prehend::dds {
namespace {

using std::chrono::milliseconds;

// What was sent before a departure may come after it.
constexpr Duration on_its_way = milliseconds(1000);
// Who has left is silent for this time; it is half of the usual lease.
constexpr Duration gone = std::chrono::seconds(10), look_period = milliseconds(250);
constexpr std::size_t max_departure = 2048;  // bytes
// Who is met again has begun its handshake within this time, or even ended it. Whoever joins anew
// for nothing loses half a second; whoever waits for what never comes loses all that it waits.
constexpr Duration meeting = milliseconds(800), longer_meeting = milliseconds(1200);
// Announcements come every half second.
constexpr Duration recently = milliseconds(1100);
constexpr Duration max_silence = std::chrono::seconds(120);
/// A lease that would end between two announcements.
constexpr Duration min_lease = std::chrono::seconds(2);

/// An authenticated participant's identity begins with a one (DDS Security 1.1, 9.3.3).
bool has_keys(const GuidPrefix& prefix) {
  return prefix[0] & 0x80;
}

}  // namespace

Members::Verdict Members::judge(const GuidPrefix& sender, std::span<const std::uint8_t> message,
                                Time now, bool announces) {
  if (!secured_ && !announces) return Verdict::pass;
  const bool matters = secured_ && has_keys(sender);
  const Plaintext said = read_plaintext(message);
  if (matters && said.out_of_place) return Verdict::not_encrypted;
  const bool discovers = said.departs || !said.announcements.empty();
  auto found = all_.find(sender);
  if (found == all_.end() && !(discovers || (matters && said.shakes_hands))) return Verdict::pass;
  Member* member = found == all_.end() ? find_or_make(sender, now) : &found->second;
  if (!member) return Verdict::pass;
  if (member->departures > 0 && !said.departs && now - member->departed > on_its_way) {
    forged_ += member->departures;
    member->departures = 0;
    member->departure.clear();
  }
  member->heard = now;
  member->shook_hands |= said.shakes_hands;
  if (said.departs) {
    ++member->departures;
    member->departed = now;
    if (!matters || !member->is_in) return Verdict::pass;
    if (message.size() <= max_departure) member->departure.assign(message.begin(), message.end());
    return Verdict::keep;
  }
  if (!matters || said.announcements.empty()) return Verdict::pass;
  if (!agrees(*member, said)) return Verdict::contradicts;
  if (member->is_lost) {
    if (!member->back || now - member->announced.value_or(now) > recently) {
      member->back = now;
      member->shook_hands = false;
    }
    member->announced = now;
  }
  return Verdict::pass;
}

/// Is what a message announces what has been announced before? Whoever is not let in yet may say
/// something else: nobody knows which is true.
bool Members::agrees(Member& member, const Plaintext& said) {
  for (const auto& one : said.announcements) {
    if (one.lease && *one.lease < min_lease) return false;
    const bool known = std::any_of(member.said.begin(), member.said.end(), [&](const auto& before) {
      return std::equal(before.begin(), before.end(), one.content.begin(), one.content.end());
    });
    if (known) continue;
    if (member.is_in || member.said.size() == max_said) return false;
    member.said.emplace_back(one.content.begin(), one.content.end());
  }
  return true;
}

Members::Member* Members::find_or_make(const GuidPrefix& peer, Time now) {
  if (all_.size() >= max_known)
    std::erase_if(all_, [&](const auto& entry) {
      return !entry.second.is_in && now - entry.second.heard > max_silence;
    });
  if (all_.size() >= max_known) return nullptr;
  Member& made = all_[peer];
  made.heard = now;
  return &made;
}

std::vector<std::vector<std::uint8_t>> Members::take_departures(Time now) {
  std::vector<std::vector<std::uint8_t>> due;
  if (now < next_look_) return due;
  next_look_ = now + look_period;
  for (auto& [peer, member] : all_)
    if (!member.departure.empty() && now - member.heard > gone)
      due.push_back(std::exchange(member.departure, {}));
  return due;
}

std::uint64_t Members::take_forged() {
  return std::exchange(forged_, 0);
}

void Members::let_in(const GuidPrefix& peer) {
  const auto found = all_.find(peer);
  if (found == all_.end()) return;
  Member& member = found->second;
  member.is_in = true;
  member.is_lost = false;
  member.back.reset();
  member.announced.reset();
}

void Members::lost(const GuidPrefix& peer) {
  const auto found = all_.find(peer);
  if (found == all_.end() || !found->second.is_in) return;
  Member& member = found->second;
  member.is_in = false;
  // Who said that it leaves, and did, is not missed.
  member.is_lost = member.departures == 0;
  member.said.clear();
}

bool Members::is_stranded(Time now) const {
  return std::any_of(all_.begin(), all_.end(), [&](const auto& entry) {
    const Member& member = entry.second;
    return member.is_lost && member.back && member.announced &&
           now - *member.announced <= recently &&
           now - *member.back > (member.shook_hands ? longer_meeting : meeting);
  });
}

bool Members::shook_hands(const GuidPrefix& peer) const {
  const auto found = all_.find(peer);
  return found != all_.end() && found->second.shook_hands;
}

}  // namespace prehend::dds
