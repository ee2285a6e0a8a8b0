#include "services/console/core/playback.hpp"

#include <bit>
#include <cmath>

namespace prehend::console {
namespace {

constexpr char request_code = 3, state_code = 5;
constexpr std::size_t max_id = 256;

/// Little endian. What is not there fails all that follows.
class Bytes {
 public:
  explicit Bytes(std::string_view bytes) : rest_(bytes) {}

  template <class Number>
  Number number() {
    Number made = 0;
    if (rest_.size() < sizeof made) {
      good_ = false;
      return 0;
    }
    for (std::size_t i = 0; i < sizeof made; ++i)
      made |= static_cast<Number>(Number{static_cast<unsigned char>(rest_[i])} << (8 * i));
    rest_.remove_prefix(sizeof made);
    return made;
  }
  std::string text() {
    const auto size = number<std::uint32_t>();
    if (!good_ || size > max_id || size > rest_.size()) {
      good_ = false;
      return {};
    }
    return std::string(rest_.substr(0, size));
  }
  bool good() const { return good_; }

 private:
  std::string_view rest_;
  bool good_ = true;
};

template <class Number>
void put(std::string& bytes, Number value) {
  for (std::size_t i = 0; i < sizeof value; ++i)
    bytes += static_cast<char>(value >> (8 * i) & 0xffU);
}

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
  made.id = in.text();
  if (!in.good() || !std::isfinite(made.speed) || made.speed <= 0) return std::nullopt;
  if (seeks) {
    if (time >> 63 != 0) return std::nullopt;
    made.seek_ns = static_cast<std::int64_t>(time);
  }
  return made;
}

std::string playback_message(const PlaybackState& state) {
  std::string bytes(1, state_code);
  put(bytes, static_cast<std::uint8_t>(state.status));
  put(bytes, static_cast<std::uint64_t>(state.time_ns));
  put(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(state.speed)));
  put(bytes, static_cast<std::uint8_t>(state.sought));
  put(bytes, static_cast<std::uint32_t>(state.id.size()));
  return bytes + state.id;
}

}  // namespace prehend::console
