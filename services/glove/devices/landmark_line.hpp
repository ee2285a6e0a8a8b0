#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "services/glove/core/bare_hand.hpp"

/// What a hand tracking program (webcam, headset, Leap) sends to the `landmarks` device: one line
/// of JSON a hand, UTF-8, version 1. Several lines may share a datagram.
///
///   {"version": 1, "stamp_s": 1732200000.125, "hand": "right", "origin": "room",
///    "points_m": [[x, y, z], …]}
///
///   version   1
///   stamp_s   optional: time of the picture, s since 1970-01-01T00:00:00Z on this machine's clock;
///             ms, µs and ns are told by their size
///   hand      "left" or "right", in any letters: whose hand it is
///   origin    "room": the points are where the hand is, in one frame that stays where it is, the
///             tracker's (tracker.X_WT). "hand": only relative to each other they are right, as of
///             a webcam; the hand is then held at the scene's X_WH
///   points_m  21 points as MediaPipe has them (bare_hand.hpp), or 25 in the order of WebXR, which
///             also has the four metacarpals, or the 26 of OpenXR, with the palm first; metres, at
///             most 5 from the origin
///   controller  in place of points_m, of one that a hand holds: {"position_m": [x, y, z],
///             "orientation": [w, x, y, z], "trigger": 0 to 1, "grip": 0 to 1}, the grip pose of
///             OpenXR (held_controller.hpp)
///   buttons   optional: numbers of the buttons that are held, 1 to 8; [] for none. Who has buttons
///             says so in every line
namespace prehend::glove {

inline constexpr int landmark_line_version = 1;

struct LandmarkLine {
  std::optional<double> stamp;  // s
  bool left = false;
  bool in_room = false;
  Landmarks points;                                 // m
  std::optional<std::vector<std::uint8_t>> held{};  // buttons; nothing: it has none
};

/// Fails with the reason why it cannot be used: "unreadable", "unknown version", "wrong count",
/// "not finite", "in millimetres", "in centimetres" or "out of range".
tl::expected<LandmarkLine, std::string_view> parse_landmarks(std::string_view line);

/// The 21 landmarks among 21, 25 or 26 joints (see above), m. Fails with the reason, as
/// parse_landmarks().
tl::expected<Landmarks, std::string_view> landmarks_among(
    const std::vector<Eigen::Vector3d>& joints, bool left);

/// The documents of a datagram, one after the other: a line each, or several in a line. What is
/// none goes up to the end of its line.
std::vector<std::string_view> documents_in(std::string_view datagram);

/// The line, without a line break. `webxr`: with 25 points, metacarpals halfway from the wrist.
std::string to_line(const LandmarkLine& line, bool webxr = false);

}  // namespace prehend::glove
