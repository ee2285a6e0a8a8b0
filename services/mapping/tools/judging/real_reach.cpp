#include "services/mapping/tools/judging/real_reach.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/model/placement.hpp"

namespace prehend::mapping {

namespace {

using Eigen::Vector3d;

constexpr double min_drop = 0.04;  // m, of the span, that is a closing
constexpr double back = 0.015;     // m, by which the span grows again when it has ended
constexpr double max_time = 3;     // s
constexpr double pad = 0.008;      // m, from where a fingertip is tracked to its skin
constexpr double max_off = std::numbers::pi / 4;
constexpr double min_bend = 0.2;   // of the index finger, from open to fist
constexpr double unbent = 0.1;     // by which it opens again when it has closed
constexpr double stays_out = 0.5;  // of its bending, less by which the little finger takes no part

const Vector3d& tip(const RealTake::Frame& frame, model::Finger finger) {
  return frame.fingertips[static_cast<std::size_t>(finger)].p_HF;
}

Vector3d fingers(const RealTake::Frame& frame) {
  return 0.5 * (tip(frame, model::Finger::index) + tip(frame, model::Finger::middle));
}

double span(const RealTake::Frame& frame) {
  return (tip(frame, model::Finger::thumb) - fingers(frame)).norm();
}

/// How far thumb, index and little finger are bent; not at all where a fingertip is not usable.
Vector3d bent(const RealTake& take, std::size_t frame) {
  const auto seen = features(take.frames[frame].fingertips, take.hand_scale);
  return seen ? bending(*seen) : Vector3d(Vector3d::Zero());
}

/// Fingers go on when the thumb has met them, as in a fist: up to where the index finger is bent
/// most.
std::size_t fully_bent(const RealTake& take, std::size_t from) {
  std::size_t most = from;
  for (std::size_t i = from; i < take.frames.size(); ++i) {
    const double now = bent(take, i)[1], before = bent(take, most)[1];
    if (now > before) most = i;
    if (now < before - unbent || take.frames[i].time > take.frames[from].time + max_time) break;
  }
  return most;
}

/// None where the fingertips come together but fingers do not bend.
std::optional<RealClosing> closing_between(const RealTake& take, std::size_t open,
                                           std::size_t met) {
  if (span(take.frames[open]) - span(take.frames[met]) < min_drop ||
      take.frames[met].time - take.frames[open].time > max_time)
    return std::nullopt;
  const std::size_t closed = fully_bent(take, met);
  const Vector3d bends = bent(take, closed) - bent(take, open);
  if (bends[1] < min_bend) return std::nullopt;
  return RealClosing{&take,
                     open,
                     closed,
                     span(take.frames[open]),
                     span(take.frames[met]),
                     bends[2] < stays_out * bends[1]};
}

/// Of the object between fingers that close along this axis of it, m.
double width_along(const model::Shape& shape, const Vector3d& axis_O) {
  const Vector3d half = half_extents(shape);
  if (shape.kind != model::ShapeKind::box && std::abs(axis_O.z()) < 0.5) return 2 * half.x();
  Eigen::Index across = 0;
  axis_O.cwiseAbs().maxCoeff(&across);
  return 2 * half[across];
}

/// The person's grasp frame in that which gloves suppose, at this frame.
Pose own_grasp_frame(const RealTake::Frame& frame, const RealTake& take, bool pinch) {
  const Pose X_GH = model::HumanHand(take.hand_scale).X_HG().inverse();
  const Vector3d thumb = X_GH * tip(frame, model::Finger::thumb), others = X_GH * fingers(frame);
  const Vector3d closing = (others - thumb).normalized();
  Vector3d middle = 0.5 * (thumb + others);
  if (!pinch) middle.z() = 0;
  const Vector3d approach = (Vector3d::UnitZ() - closing * closing.z()).normalized();
  return make_pose(middle, model::grasp_axes(approach, closing));
}

}  // namespace

std::vector<RealClosing> closings_of(const RealTake& take) {
  std::vector<RealClosing> found;
  std::size_t open = 0, met = 0;
  const auto end = [&] {
    if (met == open) return;
    if (auto closing = closing_between(take, open, met)) found.push_back(*closing);
  };
  for (std::size_t i = 1; i < take.frames.size(); ++i) {
    const double now = span(take.frames[i]);
    if (now < span(take.frames[met])) met = i;
    const bool opens = now > span(take.frames[met]) + back;
    if (opens) end();
    // While it opens, the next closing begins later.
    if (opens || (met == open && now >= span(take.frames[open]))) open = met = i;
  }
  end();
  return found;
}

std::optional<Placed> place_object(const RealClosing& closing, const RobotGrasp& grasp) {
  if (closing.pinch != (grasp.type == GraspType::precision)) return std::nullopt;
  const RealTake& take = *closing.take;
  const Vector3d axis_O = grasp.X_OG.linear().col(1);
  const double apart = width_along(grasp.shape, axis_O) + 2 * pad;
  if (closing.open_span < apart || closing.closed_span > apart) return std::nullopt;
  Placed placed;
  placed.touch = closing.open;
  while (span(take.frames[placed.touch]) > apart) ++placed.touch;
  const RealTake::Frame& frame = take.frames[placed.touch];
  placed.X_GG = own_grasp_frame(frame, take, closing.pinch);
  placed.off_axis = std::acos(std::clamp(placed.X_GG.linear().col(1).y(), -1.0, 1.0));
  if (placed.off_axis > max_off) return std::nullopt;
  const Pose X_OH =
      grasp.X_OG * placed.X_GG.inverse() * model::HumanHand(take.hand_scale).X_HG().inverse();
  double squares = 0;
  constexpr std::array touching{model::Finger::thumb, model::Finger::index, model::Finger::middle};
  for (const model::Finger finger : touching) {
    const double off = signed_distance(grasp.shape, X_OH * tip(frame, finger)) - pad;
    squares += off * off;
  }
  placed.off_surface = std::sqrt(squares / touching.size());
  return placed;
}

RecordedTake real_reach(const RealClosing& closing, const RobotGrasp& grasp, const Placed& placed,
                        const TakeOptions& options) {
  const RealTake& take = *closing.take;
  RecordedTake made;
  made.user = fmt::format("real {} at {:.1f} s, off by {:.0f} mm and {:.0f}°", take.name,
                          take.frames[placed.touch].time, 1000 * placed.off_surface,
                          placed.off_axis * 180 / std::numbers::pi);
  made.X_WO = make_pose(Vector3d(0, 0, half_extents(grasp.shape).z()));
  made.X_WG = made.X_WO * grasp.X_OG * placed.X_GG.inverse();
  const Pose X_GH = model::HumanHand(take.hand_scale).X_HG().inverse();
  const double open = take.frames[closing.open].time, closed = take.frames[closing.closed].time;
  made.closed = Time(seconds(reach_time + closed - open));
  std::size_t frame = closing.open;
  for (int i = 0; i <= static_cast<int>((reach_time + closed - open + keep_time) * glove_rate);
       ++i) {
    const double t = i / glove_rate;
    while (frame < closing.closed && take.frames[frame + 1].time <= open + t - reach_time) ++frame;
    Posture posture;
    posture.stamp = posture.origin = Time(seconds(t));
    posture.X_WH = made.X_WG * approach_at(t) * X_GH;
    posture.hand_scale = take.hand_scale;
    posture.fingertips = take.frames[frame].fingertips;
    made.postures.push_back(posture);
  }
  see_object(made, grasp.shape, static_cast<std::uint64_t>(closing.open), options);
  return made;
}

std::vector<BenchmarkTake> real_takes(const std::vector<RealTake>& people,
                                      const std::vector<RobotGrasp>& grasps, int each, int first,
                                      const TakeOptions& options) {
  std::vector<RealClosing> closings;
  for (const RealTake& take : people)
    for (RealClosing& closing : closings_of(take)) closings.push_back(closing);
  std::vector<BenchmarkTake> takes;
  for (const RobotGrasp& grasp : grasps) {
    std::vector<std::pair<const RealClosing*, Placed>> fitting;
    for (const RealClosing& closing : closings)
      if (const auto placed = place_object(closing, grasp)) fitting.emplace_back(&closing, *placed);
    std::ranges::stable_sort(fitting, {}, [](const auto& one) { return one.second.off_surface; });
    if (fitting.size() > static_cast<std::size_t>(each))
      fitting.resize(static_cast<std::size_t>(each));
    for (const auto& [closing, placed] : fitting)
      takes.push_back({first + static_cast<int>(takes.size()), grasp,
                       real_reach(*closing, grasp, placed, options), true});
  }
  return takes;
}

}  // namespace prehend::mapping
