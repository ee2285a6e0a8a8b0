#include "recording.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include "bare_hand.hpp"

namespace prehend::glove {
namespace {

using Eigen::Vector3d;

/// One row of a recording.
struct Hand {
  double time = 0;  // s
  BareHand bare;
};

std::vector<std::string_view> split(std::string_view line, char separator) {
  std::vector<std::string_view> parts;
  while (true) {
    const std::size_t end = line.find(separator);
    parts.push_back(line.substr(0, end));
    if (end == std::string_view::npos) return parts;
    line.remove_prefix(end + 1);
  }
}

using Columns = std::map<std::string_view, std::size_t, std::less<>>;

/// One row, read by the names of its columns. Anything missing or unreadable makes it bad.
class Row {
 public:
  Row(const Columns& columns, std::vector<std::string_view> cells)
      : columns_(columns), cells_(std::move(cells)) {}

  std::string_view text(std::string_view name) {
    const auto column = columns_.find(name);
    if (column == columns_.end() || column->second >= cells_.size()) {
      bad_ = true;
      return {};
    }
    return cells_[column->second];
  }
  double number(std::string_view name) {
    const std::string_view cell = text(name);
    double value = 0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value))
      bad_ = true;
    return value;
  }
  Vector3d vector(const std::string& name) {
    const double x = number(name + "_x"), y = number(name + "_y"), z = number(name + "_z");
    return {x, y, z};
  }
  bool bad() const { return bad_; }

 private:
  const Columns& columns_;
  std::vector<std::string_view> cells_;
  bool bad_ = false;
};

Hand read_leap(Row& row) {
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

Hand read_landmarks(Row& row, double rate) {
  Hand hand;
  hand.time = row.number("frame") / rate;
  Landmarks points;
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = row.vector(fmt::format("l{}", i));
  hand.bare = bare_hand(points, false);
  return hand;
}

}  // namespace

Expected<Recording> Recording::load(const std::filesystem::path& file,
                                    const RecordingOptions& options) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream || std::filesystem::is_directory(file))
    return fail("the recording cannot be read", file.string(),
                "set glove.file to a file that exists");
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  return parse(text, file.string(), options);
}

Expected<Recording> Recording::parse(std::string_view text, std::string_view name,
                                     const RecordingOptions& options) {
  const std::string where(name);
  if (!(options.rate > 0 && options.rate <= 1000))
    return fail("the rate must be above 0 and at most 1000 Hz", where, "set recording_rate");
  Columns columns;
  bool leap = false, has_columns = false;
  std::vector<Hand> hands;
  Recording made;
  for (std::string_view line : split(text, '\n')) {
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (line.empty()) continue;
    const auto cells = split(line, ',');
    if (!has_columns) {
      for (std::size_t i = 0; i < cells.size(); ++i) columns.emplace(cells[i], i);
      leap = columns.contains("t_us") && columns.contains("palm_x");
      if (!leap && !(columns.contains("frame") && columns.contains("l20_z")))
        return fail("neither a Leap nor a 21-landmark recording", where,
                    "the first line must name the columns");
      has_columns = true;
      continue;
    }
    Row row(columns, cells);
    const Hand hand = leap ? read_leap(row) : read_landmarks(row, options.rate);
    if (row.bad())
      ++made.unreadable_;
    else
      hands.push_back(hand);
  }

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

std::optional<Frame> Recording::frame(std::uint64_t n) const {
  if (n >= frames_.size()) return std::nullopt;
  return frames_[n];
}

}  // namespace prehend::glove
