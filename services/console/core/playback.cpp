#include "services/console/core/playback.hpp"

#include <bit>
#include <cmath>

#include "services/console/core/bytes.hpp"

namespace prehend::console {
namespace {

constexpr char request_code = 3, state_code = 5;
constexpr std::size_t max_id = 256;

}  // namespace

std::optional<PlaybackRequest> read_playback(std::string_view bytes) {
  if (!bytes.starts_with(request_code)) return std::nullopt;
  Bytes in(bytes.substr(1));
  PlaybackRequest made;
  const auto command = in.number<std::uint8_t>();
  // Others than to play and to pause are not of the protocol; our page asks so at its start.
  made.play = command < 2 ? std::optional(command == 0) : std::nullopt;
  made.speed = std::bit_cast<float>(in.number<std::uint32_t>());
  const bool seeks = in.number<std::uint8_t>() != 0;
  const auto time = in.number<std::uint64_t>();
  made.id = in.text(max_id);
  if (!in.good() || !std::isfinite(made.speed) || made.speed <= 0) return std::nullopt;
  if (seeks) {
    if (time >> 63 != 0) return std::nullopt;
    made.seek_ns = static_cast<std::int64_t>(time);
  }
  return made;
}

std::string playback_message(const PlaybackState& state) {
  std::string bytes(1, state_code);
  put_number(bytes, static_cast<std::uint8_t>(state.status));
  put_number(bytes, static_cast<std::uint64_t>(state.time_ns));
  put_number(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(state.speed)));
  put_number(bytes, static_cast<std::uint8_t>(state.sought));
  put_number(bytes, static_cast<std::uint32_t>(state.id.size()));
  return bytes + state.id;
}

}  // namespace prehend::console
