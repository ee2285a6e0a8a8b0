#include "services/mapping/tools/judging/real_take.hpp"

#include <fmt/format.h>

#include <array>
#include <optional>
#include <string>

#include "common/base/csv_rows.hpp"
#include "common/base/file_text.hpp"

namespace prehend::mapping {

namespace {

using Eigen::Vector3d;

/// Fastest that frames are kept, a tracker's rate.
constexpr double period = 1 / 30.;  // s

/// What a camera tells of a hand, in its own axes, m.
struct Seen {
  Vector3d forward, out, knuckle;  // along the hand, out of its back; middle knuckle
  std::array<Vector3d, model::finger_count> tips;
};

/// A frame whose fingertips are taken from the middle knuckle, along the axes of H.
std::optional<RealTake::Frame> in_hand(const Seen& seen, RealTake::Frame frame) {
  const Vector3d y = seen.out.cross(seen.forward);
  if (y.norm() <= 1e-3 * seen.out.norm() * seen.forward.norm()) return std::nullopt;
  Eigen::Matrix3d R_RH;
  R_RH.col(0) = seen.forward.normalized();
  R_RH.col(1) = y.normalized();
  R_RH.col(2) = R_RH.col(0).cross(R_RH.col(1));
  for (std::size_t f = 0; f < seen.tips.size(); ++f)
    frame.fingertips[f] = {true, R_RH.transpose() * (seen.tips[f] - seen.knuckle)};
  return frame;
}

std::optional<RealTake::Frame> read_leap(CsvRow& row) {
  constexpr double mm = 1e-3;
  static const std::array<std::string, model::finger_count> fingers{"thumb", "index", "middle",
                                                                    "ring", "pinky"};
  RealTake::Frame frame;
  frame.time = 1e-6 * row.number("t_us");
  frame.grab = row.number("grabStrength");
  frame.pinch = row.number("pinchStrength");
  Seen seen{row.vector("dir"), -row.vector("normal"), mm * row.vector("middle_mcp"), {}};
  for (std::size_t f = 0; f < fingers.size(); ++f)
    seen.tips[f] = mm * row.vector(fingers[f] + "_tip");
  if (row.bad() || row.text("hand") != "right") return std::nullopt;
  return in_hand(seen, frame);
}

/// 21 points of a right hand, wrist first, four a finger from its root on; no times.
std::optional<RealTake::Frame> read_landmarks(CsvRow& row) {
  RealTake::Frame frame;
  frame.time = row.number("frame") * period;
  const auto point = [&](std::size_t i) { return row.vector(fmt::format("l{}", i)); };
  const Vector3d wrist = point(0);
  // Wrist, index knuckle and little knuckle span the back of the hand.
  Seen seen{point(9) - wrist, (point(17) - wrist).cross(point(5) - wrist), point(9), {}};
  for (std::size_t f = 0; f < seen.tips.size(); ++f) seen.tips[f] = point(4 * f + 4);
  if (row.bad()) return std::nullopt;
  return in_hand(seen, frame);
}

/// How much further this finger reaches from the knuckle than that of an average open hand.
double scale_of(const RealTake& take, model::Finger finger, const Vector3d& p_HKnuckle) {
  const auto f = static_cast<std::size_t>(finger);
  double furthest = 0;
  for (const RealTake::Frame& frame : take.frames)
    furthest = std::max(furthest, frame.fingertips[f].p_HF.norm());
  const auto open = model::HumanHand(1).fingertip_poses(model::HumanHand::open_posture());
  return furthest / (open[f].translation() - p_HKnuckle).norm();
}

/// From the middle knuckle to H: the hand is as large as its fingers reach.
void stand_on_knuckle(RealTake& take) {
  const Vector3d p_HKnuckle(0.0557, 0.0, -0.013);  // of an average hand, as the glove has it
  take.hand_scale = 0.5 * (scale_of(take, model::Finger::index, p_HKnuckle) +
                           scale_of(take, model::Finger::little, p_HKnuckle));
  for (RealTake::Frame& frame : take.frames)
    for (Fingertip& tip : frame.fingertips) tip.p_HF += take.hand_scale * p_HKnuckle;
}

}  // namespace

Expected<RealTake> load_real_take(const std::filesystem::path& csv) {
  const auto text = read_file(csv);
  if (!text) return tl::unexpected(text.error());
  CsvRows rows(*text);
  if (rows.empty()) return fail("the recording cannot be read", csv.string());
  RealTake take{csv.stem().string(), 1, {}};
  double last = -period;
  std::optional<double> first;
  const bool landmarks = rows.has("l20_z");
  while (auto row = rows.next()) {
    auto frame = landmarks ? read_landmarks(*row) : read_leap(*row);
    if (!frame) continue;
    if (!first) first = frame->time;
    frame->time -= *first;
    constexpr double rounding = 1e-6;  // s
    if (frame->time < last + period - rounding) continue;
    last = frame->time;
    take.frames.push_back(*frame);
  }
  constexpr std::size_t least = 10;
  if (take.frames.size() < least)
    return fail(fmt::format("has {} good rows of a right hand", take.frames.size()), csv.string(),
                "choose a Leap or a 21-landmark recording");
  stand_on_knuckle(take);
  return take;
}

}  // namespace prehend::mapping
