#include "services/glove/files/hand_recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/csv_rows.hpp"
#include "common/base/file_text.hpp"
#include "services/glove/core/bare_hand.hpp"
#include "services/glove/core/plausible_hand.hpp"

namespace prehend::glove {
namespace {

using Eigen::Vector3d;

/// One row of a recording.
struct Hand {
  double time = 0;  // s
  BareHand bare;
  std::optional<Landmarks> points{};  // of which it was made
  std::size_t line = 0;               // of the text
};

/// Where rows say when they were seen.
struct TimeColumn {
  std::string name;
  double unit = 1;  // s
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

Hand read_landmarks(CsvRow& row, const TimeColumn& time) {
  Hand hand;
  hand.time = row.number(time.name) * time.unit;
  hand.points.emplace();
  for (std::size_t i = 0; i < hand.points->size(); ++i)
    (*hand.points)[i] = row.vector(fmt::format("l{}", i));
  hand.bare = bare_hand(*hand.points, false);
  return hand;
}

Expected<TimeColumn> time_column(const CsvRows& rows, double rate, const std::string& where) {
  constexpr std::array names{"timestamp", "time", "stamp", "t"};
  constexpr std::array units{std::pair("_s", 1.0), std::pair("_ms", 1e-3), std::pair("_us", 1e-6),
                             std::pair("_ns", 1e-9)};
  for (const std::string name : names)
    for (const auto& [ending, unit] : units)
      if (rows.has(name + ending)) return TimeColumn{name + ending, unit};
  if (rows.has("frame")) return TimeColumn{"frame", 1 / rate};
  for (const std::string name : names)
    if (rows.has(name))
      return fail(fmt::format("the column {} does not say its unit", name), where,
                  fmt::format("call it {0}_s, {0}_ms, {0}_us or {0}_ns", name));
  return fail("no column says when a row was seen", where, "frame, or timestamp_ms and the like");
}

constexpr double min_finger = 0.02, max_finger = 0.3;  // m, middle knuckle to tip
constexpr double min_interval = 5e-4;                  // s, between frames on average
constexpr double restart = 0.5;                        // s back: not one row that comes late
constexpr double min_gap = 0.05;                       // s

/// Whether lengths of a Leap recording are those of a hand.
Expected<void> check_lengths(const std::vector<Hand>& hands, const std::string& where) {
  std::vector<double> reach;
  for (const Hand& hand : hands) reach.push_back((hand.bare.tip_R[2] - hand.bare.knuckle_R).norm());
  std::sort(reach.begin(), reach.end());
  const bool small = reach.back() < min_finger;
  if (!small && reach[reach.size() / 2] <= max_finger) return {};
  return fail(fmt::format("the middle finger is {:.2g} m long",
                          small ? reach.back() : reach[reach.size() / 2]),
              where, "positions are in mm");
}

Expected<void> check_times(const std::vector<Hand>& hands, bool leap, const std::string& where) {
  const auto [first, last] = std::ranges::minmax(hands, {}, &Hand::time);
  const double length = last.time - first.time;
  if (hands.size() <= 10 || !(length > 0) ||
      length / static_cast<double>(hands.size()) >= min_interval)
    return {};
  return fail("its frames are less than half a millisecond apart", where,
              leap ? "t_us is in µs" : "is the unit of its times as the column says?");
}

/// Most rows: which hand their bent fingers are of.
bool are_left(const std::vector<Hand>& hands) {
  std::size_t left = 0, right = 0;
  for (const Hand& hand : hands) {
    if (!hand.points) continue;
    left += why_no_hand(*hand.points, false) == mirrored_hand;
    right += why_no_hand(*hand.points, true) == mirrored_hand;
  }
  return left > right;
}

}  // namespace

Expected<Recording> Recording::load(const std::filesystem::path& file,
                                    const RecordingOptions& options) {
  const auto text = read_file(file, "set glove.file to a recording");
  if (!text) return tl::unexpected(text.error());
  return parse(*text, file.string(), options);
}

/// One recording while it is read.
class RecordingReader {
 public:
  RecordingReader(std::string_view name, const RecordingOptions& options)
      : where_(name), options_(options) {}

  Expected<Recording> read(std::string_view text) {
    if (auto done = read_rows(text); !done) return tl::unexpected(done.error());
    if (auto done = check_hands(); !done) return tl::unexpected(done.error());
    std::size_t left = 0;
    for (const Hand& hand : hands_) left += hand.bare.left;
    made_.left_ = left > 0 && left == hands_.size();
    put_in_order();
    for (Hand& hand : hands_) add(hand);
    if (made_.frames_.empty())
      return fail("there is no frame in the recording", where_, "choose another file");
    find_gaps();
    return std::move(made_);
  }

 private:
  Expected<void> read_rows(std::string_view text) {
    CsvRows rows(text);
    leap_ = rows.has("t_us") && rows.has("palm_x");
    TimeColumn time;
    if (!rows.empty() && !leap_) {
      if (!rows.has("l0_x") || !rows.has("l20_z"))
        return fail("neither a Leap nor a 21-landmark recording", where_,
                    "the first line must name the columns: frame,l0_x,l0_y,l0_z,…,l20_z");
      const auto column = time_column(rows, options_.rate, where_);
      if (!column) return tl::unexpected(column.error());
      time = *column;
    }
    while (auto row = rows.next()) {
      Hand hand = leap_ ? read_leap(*row) : read_landmarks(*row, time);
      hand.line = row->line();
      if (row->bad())
        ++made_.unreadable_;
      else
        hands_.push_back(std::move(hand));
    }
    return {};
  }

  /// Leaves out what is no hand; fails where that is most of it.
  Expected<void> check_hands() {
    if (hands_.empty()) return {};
    if (auto ok = check_times(hands_, leap_, where_); !ok) return ok;
    if (leap_) return check_lengths(hands_, where_);
    const bool left = are_left(hands_);
    if (left) made_.remarks_.push_back("its fingers bend as those of a left hand: it is mirrored");
    const std::size_t all = hands_.size();
    std::erase_if(hands_, [&](const Hand& hand) {
      const std::string_view why = why_no_hand(*hand.points, left);
      if (!why.empty()) ++made_.no_hands_[std::string(why)];
      return !why.empty();
    });
    for (Hand& hand : hands_) hand.bare = bare_hand(*hand.points, left);
    if (2 * hands_.size() >= all) return {};
    const auto& [why, count] = *std::ranges::max_element(
        made_.no_hands_, {}, [](const auto& entry) { return entry.second; });
    return fail(fmt::format("{} of {} rows are {}", count, all, why), where_,
                std::string(advice_on(why)));
  }

  /// Numbers that begin anew go on where those before ended.
  void put_in_order() {
    double last = hands_.empty() ? 0 : hands_.front().time, offset = 0, step = 1 / options_.rate;
    for (Hand& hand : hands_) {
      double time = hand.time + offset;
      if (last - time > restart) {
        offset += last + step - time;
        time = last + step;
        made_.remarks_.push_back(
            fmt::format("times begin anew in line {}: what follows is taken to go on", hand.line));
      }
      if (time > last) step = time - last;
      last = std::max(last, time);
      hand.time = time;
    }
  }

  void add(Hand& hand) {
    if (hand.bare.left && !made_.left_) {
      ++made_.other_hand_;
      return;
    }
    if (hand.bare.left) mirror(hand.bare, Vector3d::UnitX());
    auto frame =
        sensors_on(hand.bare, options_.hand_scale, options_.X_WT.inverse() * options_.X_WH);
    // Days before or later: nonsense.
    const double since = hand.time - first_.value_or(hand.time);
    if (frame && std::abs(since) < 1e6) frame->stamp = Time(seconds(since));
    // Two hands of the same kind in one picture: the second is a false one.
    if (!frame || !(std::abs(since) < 1e6) ||
        (!made_.frames_.empty() && frame->stamp <= made_.frames_.back().stamp)) {
      ++made_.unreadable_;
      return;
    }
    if (!first_) first_ = hand.time;
    frame->sequence = made_.frames_.size();
    made_.frames_.push_back(std::move(*frame));
    lines_.push_back(hand.line);
  }

  void find_gaps() {
    std::vector<double> steps;
    for (std::size_t i = 1; i < made_.frames_.size(); ++i)
      steps.push_back(to_seconds(made_.frames_[i].stamp - made_.frames_[i - 1].stamp));
    if (steps.size() < 3) return;
    std::vector<double> sorted = steps;
    std::ranges::sort(sorted);
    const double usual = sorted[sorted.size() / 2];
    const auto is_gap = [&](double step) { return step > std::max(2.5 * usual, min_gap); };
    const auto count = std::ranges::count_if(steps, is_gap);
    if (count == 0) return;
    const auto longest = std::ranges::max_element(steps);
    made_.remarks_.push_back(fmt::format(
        "{} {}, the longest of {:.2f} s before line {}", count, count == 1 ? "gap" : "gaps",
        *longest, lines_[static_cast<std::size_t>(longest - steps.begin()) + 1]));
  }

  std::string where_;
  const RecordingOptions& options_;
  bool leap_ = false;
  std::vector<Hand> hands_;
  std::vector<std::size_t> lines_;  // of the frames
  std::optional<double> first_;
  Recording made_;
};

Expected<Recording> Recording::parse(std::string_view text, std::string_view name,
                                     const RecordingOptions& options) {
  if (!(options.rate > 0 && options.rate <= 1000))
    return fail("the rate must be above 0 and at most 1000 Hz", std::string(name),
                "set recording_rate of the scene");
  return RecordingReader(name, options).read(text);
}

std::string Recording::left_out() const {
  std::string told;
  if (unreadable_ > 0)
    told =
        fmt::format("{} rows say nothing usable, or are not later than those before", unreadable_);
  if (other_hand_ > 0)
    told += fmt::format("{}{} rows of the left hand", told.empty() ? "" : "; ", other_hand_);
  for (const auto& [why, count] : no_hands_)
    told += fmt::format("{}{} rows that are {}", told.empty() ? "" : "; ", count, why);
  return told;
}

std::optional<Frame> Recording::frame(std::uint64_t n) const {
  if (n >= frames_.size()) return std::nullopt;
  return frames_[n];
}

}  // namespace prehend::glove
