#include "common/dds/guard/admission.hpp"

#include <algorithm>

namespace prehend::dds {
namespace {

// A hundred thousand in ten seconds leave most of those who wait half a second in their place.
constexpr std::size_t places = 1 << 16;

std::uint64_t number_of(const GuidPrefix& prefix) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;  // FNV-1a
  for (const std::uint8_t byte : prefix) hash = (hash ^ byte) * 0x100000001b3ULL;
  return hash ^ hash >> 29;
}

}  // namespace

bool Admission::admits(const GuidPrefix& newcomer, Time now) {
  free_ = std::min(at_once, free_ + rate * std::max(0.0, to_seconds(now - last_)));
  last_ = std::max(last_, now);
  if (free_ >= 1) {
    --free_;
    return true;
  }
  waiting_.resize(places);
  const std::uint64_t who = number_of(newcomer);
  Waiting& place = waiting_[who % places];
  const Duration waited = now - place.since;
  if (place.who != who || waited > max_apart) {
    place = {who, now};
    return false;
  }
  return waited >= min_apart;
}

}  // namespace prehend::dds
