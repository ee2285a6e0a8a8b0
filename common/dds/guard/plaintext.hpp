#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/base/time.hpp"

namespace prehend::dds {

/// What a sound message (packet.hpp) says that is not encrypted, as a lab with keys sees it.
struct Plaintext {
  /// Of a participant: where it can be reached, for how long, who vouches for it.
  struct Announcement {
    std::span<const std::uint8_t> content;  // within the message
    std::optional<Duration> lease;
  };
  std::vector<Announcement> announcements;
  /// A participant is disposed or unregistered, in whatever form.
  bool departs = false;
  bool shakes_hands = false;
  /// Something that a lab with keys says encrypted only: samples, endpoints, signs of life, or
  /// which samples there are.
  bool out_of_place = false;
};
Plaintext read_plaintext(std::span<const std::uint8_t> message);

}  // namespace prehend::dds
