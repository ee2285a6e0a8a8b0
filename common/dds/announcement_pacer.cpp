#include "common/dds/announcement_pacer.hpp"

#include <algorithm>

#include "common/dds/plaintext.hpp"
#include "common/dds/rtps_parts.hpp"

namespace prehend::dds {
namespace {

constexpr std::uint8_t info_destination = 0x0e;

bool is_group(const Ipv4& address) {
  return address[0] >= 224 && address[0] < 240;
}

}  // namespace

bool AnnouncementPacer::is_due(const Place& to, const void* way, std::uint64_t number, Time now) {
  Sent& sent = find_or_make(to).ways[way];
  const bool same = sent.gap > Duration::zero() && sent.number == number;
  if (same && now < sent.next) return false;
  if (is_group(to.address))
    sent.gap = group_gap;
  else
    sent.gap = same ? std::min(2 * sent.gap, max_gap) : min_gap;
  sent.number = number;
  sent.next = now + sent.gap;
  return true;
}

void AnnouncementPacer::met(const Place& place, const GuidPrefix& participant) {
  There& there = find_or_make(place);
  if (there.participant == participant) return;
  there.participant = participant;
  there.ways.clear();
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

std::optional<std::uint64_t> announcement_number(std::span<const std::uint8_t> message) {
  using namespace wire;
  std::optional<std::uint64_t> number;
  const bool alone =
      for_each_part(message, [&](std::uint8_t kind, std::uint8_t flags, Bytes part, bool) {
        if (kind == info_timestamp || kind == info_destination || kind == statistics) return true;
        constexpr std::uint8_t content = data_flag | key_flag;
        if (kind != data || number || (flags & content) != data_flag ||
            part.size() < min_data_size || entity_at(part, 8) != participants)
          return false;
        const Numbers numbers{part, (flags & little_endian_flag) != 0};
        number = std::uint64_t{numbers.four(12)} << 32 | numbers.four(16);
        return true;
      });
  return alone ? number : std::nullopt;
}

}  // namespace prehend::dds
