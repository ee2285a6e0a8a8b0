#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

/// How a recording that is shown is led: the part of the Foxglove WebSocket for that. Pure.
namespace prehend::console {

/// What a client asks for.
struct PlaybackRequest {
  /// Nothing: it only asks how the recording plays.
  std::optional<bool> play = true;
  double speed = 1;
  std::optional<std::int64_t> seek_ns;
  std::string id;
};
/// From the bytes of a message; nothing: it is none.
std::optional<PlaybackRequest> read_playback(std::string_view bytes);

struct PlaybackState {
  enum class Status : std::uint8_t { playing, paused, buffering, ended };
  Status status = Status::playing;
  std::int64_t time_ns = 0;
  double speed = 1;
  /// What was told before is of another time: it is all told anew.
  bool sought = false;
  std::string id;  // of the request that it answers; empty: none
};
std::string playback_message(const PlaybackState& state);

}  // namespace prehend::console
