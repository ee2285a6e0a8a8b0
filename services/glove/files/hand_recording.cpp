#include "services/glove/files/hand_recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "common/base/csv_rows.hpp"
#include "common/base/file_text.hpp"
#include "services/glove/core/bare_hand.hpp"

namespace prehend::glove {
namespace {

using Eigen::Vector3d;

/// One row of a recording.
struct Hand {
  double time = 0;  // s
  BareHand bare;
};

Hand read_leap(CsvRow& row) {
  constexpr double mm = 1e-3;
  static const std::array<std::string, model::finger_count> fingers{"thumb", "index", "middle",
                                                                    "ring", "pinky"};
  Hand hand;
  hand.time = 1e-6 * row.number("t_us");
  hand.bare.left = row.text("hand") == "left";
  hand.bare.x_R = row.vector("dir");
  hand.bare.z_R = -row.vector("normal");
  hand.bare.knuckle_R = mm * row.vector("middle_mcp");
  for (std::size_t f = 0; f < fingers.size(); ++f) {
    hand.bare.tip_R[f] = mm * row.vector(fingers[f] + "_tip");
    hand.bare.before_R[f] = mm * row.vector(fingers[f] + "_dip");
  }
  return hand;
}

Hand read_landmarks(CsvRow& row, double rate) {
  Hand hand;
  hand.time = row.number("frame") / rate;
  Landmarks points;
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = row.vector(fmt::format("l{}", i));
  hand.bare = bare_hand(points, false);
  return hand;
}

constexpr double min_finger = 0.02, max_finger = 0.3;  // m, middle knuckle to tip
constexpr double min_interval = 5e-4;                  // s, between frames on average

/// Whether lengths and times are those of a hand.
Expected<void> check_units(const std::vector<Hand>& hands, bool leap, const std::string& where) {
  std::vector<double> reach;
  double earliest = INFINITY, latest = -INFINITY;
  for (const Hand& hand : hands) {
    reach.push_back((hand.bare.tip_R[2] - hand.bare.knuckle_R).norm());
    earliest = std::min(earliest, hand.time);
    latest = std::max(latest, hand.time);
  }
  if (reach.empty()) return {};
  std::sort(reach.begin(), reach.end());
  const bool small = reach.back() < min_finger;
  if (small || reach[reach.size() / 2] > max_finger)
    return fail(fmt::format("the middle finger is {:.2g} m long",
                            small ? reach.back() : reach[reach.size() / 2]),
                where, leap ? "positions are in mm" : "positions are in metres");
  if (hands.size() > 10 && latest > earliest &&
      (latest - earliest) / static_cast<double>(hands.size()) < min_interval)
    return fail("its frames are less than half a millisecond apart", where, "t_us is in µs");
  return {};
}

}  // namespace

Expected<Recording> Recording::load(const std::filesystem::path& file,
                                    const RecordingOptions& options) {
  const auto text = read_file(file, "set glove.file to a recording");
  if (!text) return tl::unexpected(text.error());
  return parse(*text, file.string(), options);
}

Expected<Recording> Recording::parse(std::string_view text, std::string_view name,
                                     const RecordingOptions& options) {
  const std::string where(name);
  if (!(options.rate > 0 && options.rate <= 1000))
    return fail("the rate must be above 0 and at most 1000 Hz", where, "set recording_rate");
  CsvRows rows(text);
  const bool leap = rows.has("t_us") && rows.has("palm_x");
  if (!rows.empty() && !leap && !(rows.has("frame") && rows.has("l20_z")))
    return fail("neither a Leap nor a 21-landmark recording", where,
                "the first line must name the columns");
  std::vector<Hand> hands;
  Recording made;
  while (auto row = rows.next()) {
    const Hand hand = leap ? read_leap(*row) : read_landmarks(*row, options.rate);
    if (row->bad())
      ++made.unreadable_;
    else
      hands.push_back(hand);
  }
  if (const auto ok = check_units(hands, leap, where); !ok) return tl::unexpected(ok.error());

  std::size_t left = 0;
  for (const Hand& hand : hands) left += hand.bare.left;
  made.left_ = left > 0 && left == hands.size();
  const Pose X_TH = options.X_WT.inverse() * options.X_WH;
  std::optional<double> first;
  for (Hand& hand : hands) {
    if (hand.bare.left && !made.left_) {
      ++made.other_hand_;
      continue;
    }
    if (hand.bare.left) mirror(hand.bare, Vector3d::UnitX());
    auto frame = sensors_on(hand.bare, options.hand_scale, X_TH);
    // Days before or later: nonsense.
    const double since = hand.time - first.value_or(hand.time);
    if (!frame || !(std::abs(since) < 1e6)) {
      ++made.unreadable_;
      continue;
    }
    frame->stamp = Time(seconds(since));
    // Two hands of the same kind in one picture: the second is a false one.
    if (!made.frames_.empty() && frame->stamp <= made.frames_.back().stamp) {
      ++made.unreadable_;
      continue;
    }
    if (!first) first = hand.time;
    frame->sequence = made.frames_.size();
    made.frames_.push_back(std::move(*frame));
  }
  if (made.frames_.empty())
    return fail("there is no frame in the recording", where, "choose another file");
  return made;
}

std::string Recording::left_out() const {
  std::string told;
  if (unreadable_ > 0)
    told =
        fmt::format("{} rows say nothing usable, or are not later than those before", unreadable_);
  if (other_hand_ > 0)
    told += fmt::format("{}{} rows of the left hand", told.empty() ? "" : "; ", other_hand_);
  return told;
}

std::optional<Frame> Recording::frame(std::uint64_t n) const {
  if (n >= frames_.size()) return std::nullopt;
  return frames_[n];
}

}  // namespace prehend::glove
