#include "common/dds/guard/announcement_pacer.hpp"

#include <algorithm>

#include "common/dds/guard/plaintext.hpp"
#include "common/dds/guard/rtps_parts.hpp"

namespace prehend::dds {
namespace {

constexpr std::uint8_t info_destination = 0x0e, final_flag = 0x02;

bool is_group(const Ipv4& address) {
  return address[0] >= 224 && address[0] < 240;
}

}  // namespace

bool AnnouncementPacer::is_due(const Place& to, const void* way, const Saying& what, Time now) {
  Sent& sent = find_or_make(to).sent[{way, what.writer, what.asks}];
  const bool same = sent.gap > Duration::zero() && sent.number == what.number;
  if (same && now < sent.next) return false;
  if (is_group(to.address))
    sent.gap = group_gap;
  else
    sent.gap = same ? std::min(2 * sent.gap, max_gap) : min_gap;
  sent.number = what.number;
  sent.next = now + sent.gap;
  return true;
}

void AnnouncementPacer::met(const Place& place, const GuidPrefix& participant) {
  There& there = find_or_make(place);
  if (there.participant == participant) return;
  there.participant = participant;
  there.sent.clear();
}

AnnouncementPacer::There& AnnouncementPacer::find_or_make(const Place& place) {
  const auto found = all_.find(place);
  if (found != all_.end()) return found->second;
  // Those who are still there are written down anew, at the cost of one announcement to each.
  if (all_.size() >= max_places) all_.clear();
  return all_[place];
}

std::vector<Place> announced_places(std::span<const std::uint8_t> message) {
  using namespace wire;
  constexpr std::uint32_t udp4 = 1;
  constexpr std::size_t head = 4, locator_size = 24, ip_in_locator = 20;
  std::vector<Place> places;
  for (const auto& announcement : read_plaintext(message).announcements)
    for_each_parameter({announcement.content.subspan(head), (announcement.content[1] & 1) != 0},
                       [&](std::uint16_t parameter, const Numbers& value) {
                         if (parameter == metatraffic_locator &&
                             value.bytes.size() >= locator_size && value.four(0) == udp4)
                           places.push_back({array_at<4>(value.bytes, ip_in_locator),
                                             static_cast<std::uint16_t>(value.four(4))});
                       });
  return places;
}

std::optional<Saying> repeated_saying(std::span<const std::uint8_t> message) {
  using namespace wire;
  std::optional<Saying> said;
  const bool alone =
      for_each_part(message, [&](std::uint8_t kind, std::uint8_t flags, Bytes part, bool) {
        if (kind == info_timestamp || kind == info_destination || kind == statistics) return true;
        const Numbers numbers{part, (flags & little_endian_flag) != 0};
        if (said || part.size() < min_data_size) return false;
        if (kind == data && (flags & (data_flag | key_flag)) == data_flag &&
            entity_at(part, 8) == participants)
          said = {participants, false, std::uint64_t{numbers.four(12)} << 32 | numbers.four(16)};
        // Nothing is known yet: what is acknowledged begins at 0 and is empty.
        else if (kind == acknack && !(flags & final_flag) && numbers.four(8) == 0 &&
                 numbers.four(12) == 0 && numbers.four(16) == 0)
          said = {entity_at(part, 4), true, 0};
        return said.has_value();
      });
  return alone ? said : std::nullopt;
}

}  // namespace prehend::dds
