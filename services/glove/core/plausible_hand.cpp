#include "services/glove/core/plausible_hand.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace prehend::glove {
namespace {

using Eigen::Vector3d;

/// From the wrist, m: the middle knuckle at least and at most, and the farthest of all points.
constexpr double short_palm = 0.04, long_palm = 0.18, long_hand = 0.35;
/// Between the knuckles of index and little finger, m, and the sine of the angle between them as
/// seen from the wrist. Of real hands: above 0.05 and 0.45.
constexpr double narrow_palm = 0.02, wide_palm = 0.15, narrow_sine = 0.15;
constexpr double one_place = 1e-3;  // m
/// Sum of two sines, of the bends of a finger, on average of four. Real right hands: above 0.
constexpr double bent_back = -0.15;

constexpr std::string_view lost = "all points in one place", millimetres = "in millimetres",
                           centimetres = "in centimetres", picture = "in image coordinates",
                           no_hand = "not a hand", collapsed = "a collapsed palm";

/// How much the fingers bend towards the palm of a right hand. A mirror changes its sign, turning
/// and moving the hand do not.
double bend(const Landmarks& p) {
  const Vector3d lateral = (p[5] - p[17]).normalized();
  double sum = 0;
  for (std::size_t f = 1; f < 5; ++f) {
    const std::size_t k = 4 * f + 1;  // its knuckle
    const Vector3d a = (p[k + 1] - p[k]).normalized(), b = (p[k + 2] - p[k + 1]).normalized(),
                   c = (p[k + 3] - p[k + 2]).normalized();
    sum += (a.cross(b) + b.cross(c)).dot(lateral);
  }
  return sum / 4;
}

/// x and y are shares of a picture's sides, z is of its own: the wrist's is 0.
bool is_picture(const Landmarks& points, double palm) {
  const bool within = std::all_of(points.begin(), points.end(), [](const Vector3d& p) {
    return p.x() > -0.5 && p.x() < 1.5 && p.y() > -0.5 && p.y() < 1.5 && std::abs(p.z()) < 1.5;
  });
  const bool flat = std::abs(points[0].z()) < 1e-6 && points[0].x() > 0.01 && points[0].y() > 0.01;
  return within && palm < 1.5 && (palm > long_palm || flat);
}

}  // namespace

std::string_view why_no_hand(const Landmarks& points, bool left) {
  double reach = 0;
  for (const Vector3d& point : points) reach = std::max(reach, (point - points[0]).norm());
  if (reach < one_place) return lost;
  const double palm = (points[9] - points[0]).norm();
  const double width = (points[5] - points[17]).norm();
  const auto is_in = [&](double unit) {  // of so many in a metre
    return palm >= unit * short_palm && palm <= unit * long_palm && width >= unit * narrow_palm &&
           width <= unit * wide_palm;
  };
  if (is_in(1000)) return millimetres;
  if (is_in(100)) return centimetres;
  if (is_picture(points, palm)) return picture;
  if (!(palm >= short_palm && palm <= long_palm && reach <= long_hand)) return no_hand;
  const Vector3d index = points[5] - points[0], little = points[17] - points[0];
  if (width < narrow_palm ||
      index.cross(little).norm() < narrow_sine * index.norm() * little.norm())
    return collapsed;
  return (left ? -bend(points) : bend(points)) < bent_back ? mirrored_hand : std::string_view();
}

std::string_view advice_on(std::string_view reason) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 12> advice{{
      {lost, "the tracker has lost the hand, and should send nothing then"},
      {millimetres, "divide by 1000: points are in metres"},
      {centimetres, "divide by 100: points are in metres"},
      {picture, "send the tracker's world landmarks: points are in metres"},
      {mirrored_hand, "it is a hand of the other side, or the camera's picture is mirrored"},
      {"not finite", "a hand with a missing point should not be sent"},
      {"frozen", "the tracker sends the same hand with new stamps"},
      {"other hand", "glove.hand says which one leads"},
      {"stale", "stamp_s is the time of the picture; are the clocks alike?"},
      {"from the future", "stamp_s is the time of the picture; are the clocks alike?"},
      {"wrong count", "send 21 points, or 25 or 26 with metacarpals"},
      {"unreadable", "see services/glove/README.md for the format"},
  }};
  for (const auto& [word, what] : advice)
    if (word == reason) return what;
  return {};
}

}  // namespace prehend::glove
