#include "recording.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

namespace prehend::glove {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// The middle knuckle in H of an average hand, m (see model::HumanHand).
const Vector3d p_HKnuckle(0.0557, 0.0, -0.013);

/// A recorded hand in the recording's own frame R.
struct Hand {
  double time = 0;  // s
  bool left = false;
  Vector3d x_R, z_R;  // towards the fingers; out of the back of the hand; any length
  Vector3d knuckle_R;
  std::array<Vector3d, model::finger_count> tip_R,
      before_R;  // fingertip and the joint before it, m
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
  hand.left = row.text("hand") == "left";
  hand.x_R = row.vector("dir");
  hand.z_R = -row.vector("normal");
  hand.knuckle_R = mm * row.vector("middle_mcp");
  for (std::size_t f = 0; f < fingers.size(); ++f) {
    hand.tip_R[f] = mm * row.vector(fingers[f] + "_tip");
    hand.before_R[f] = mm * row.vector(fingers[f] + "_dip");
  }
  return hand;
}

Hand read_landmarks(Row& row, double rate) {
  Hand hand;
  hand.time = row.number("frame") / rate;
  std::array<Vector3d, 21> l;
  for (std::size_t i = 0; i < l.size(); ++i) l[i] = row.vector(fmt::format("l{}", i));
  hand.x_R = l[9] - l[0];
  // Wrist, index knuckle and little knuckle span the back of a right hand.
  hand.z_R = (l[17] - l[0]).cross(l[5] - l[0]);
  hand.knuckle_R = l[9];
  for (std::size_t f = 0; f < model::finger_count; ++f) {
    hand.tip_R[f] = l[4 * f + 4];
    hand.before_R[f] = l[4 * f + 3];
  }
  return hand;
}

/// Frame with x along x_R and z as near to z_R as that allows; none if they span no plane.
std::optional<Matrix3d> rotation_of(const Vector3d& x_R, const Vector3d& z_R) {
  const Vector3d y = z_R.cross(x_R);
  if (!(x_R.norm() > 1e-6) || !(y.norm() > 1e-3 * x_R.norm() * z_R.norm())) return std::nullopt;
  Matrix3d R;
  R.col(0) = x_R.normalized();
  R.col(1) = y.normalized();
  R.col(2) = R.col(0).cross(R.col(1));
  return R;
}

void mirror(Hand& hand) {
  const auto flip = [](Vector3d& v) { v.x() = -v.x(); };
  flip(hand.x_R);
  flip(hand.z_R);
  flip(hand.knuckle_R);
  for (auto& p : hand.tip_R) flip(p);
  for (auto& p : hand.before_R) flip(p);
}

/// The sensors of a glove on that hand. Fails where the hand's directions say nothing.
std::optional<Frame> make_frame(const Hand& hand, const RecordingOptions& options) {
  const auto R_RH = rotation_of(hand.x_R, hand.z_R);
  if (!R_RH) return std::nullopt;
  const Pose X_RH = make_pose(hand.knuckle_R - *R_RH * (options.hand_scale * p_HKnuckle), *R_RH);
  const Pose X_TH = options.X_WT.inverse() * options.X_WH;
  const Pose X_TR = X_TH * X_RH.inverse();

  Frame frame;
  frame.left = hand.left;
  frame.readings.push_back(
      {Site::back_of_hand, true, X_TH.translation(), Eigen::Quaterniond(X_TH.linear())});
  constexpr std::array sites{Site::thumb, Site::index, Site::middle, Site::ring, Site::little};
  for (std::size_t f = 0; f < sites.size(); ++f) {
    Reading reading{sites[f]};
    const auto R_RF = rotation_of(hand.tip_R[f] - hand.before_R[f], R_RH->col(2));
    reading.p_TS = X_TR * hand.tip_R[f];
    // A fingertip that points along the normal has no orientation of its own: take the hand's.
    reading.q_TS = Eigen::Quaterniond(X_TR.linear() * R_RF.value_or(*R_RH));
    frame.readings.push_back(reading);
  }
  return frame;
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
  for (const Hand& hand : hands) left += hand.left;
  made.left_ = left > 0 && left == hands.size();
  std::optional<double> first, last;
  for (Hand& hand : hands) {
    if (hand.left && !made.left_) {
      ++made.other_hand_;
      continue;
    }
    if (hand.left) mirror(hand);
    auto frame = make_frame(hand, options);
    // Two hands of the same kind in one picture: the second is a false one. Days later: nonsense.
    const bool in_time = !last || (hand.time > *last && hand.time - *first < 1e6);
    if (!frame || !in_time) {
      ++made.unreadable_;
      continue;
    }
    last = hand.time;
    if (!first) first = hand.time;
    frame->sequence = made.frames_.size();
    frame->stamp = Time(seconds(hand.time - *first));
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
