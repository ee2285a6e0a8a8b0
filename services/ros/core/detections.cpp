#include "services/ros/core/detections.hpp"

#include <utility>

namespace prehend::ros {
namespace {

void put_header(ros2::CdrWriter& made, std::int64_t stamp_ns, std::string_view frame) {
  made.stamp(stamp_ns);
  made.put(frame);
}

void put(ros2::CdrWriter& made, const Eigen::Vector3d& v) {
  for (int i = 0; i < 3; ++i) made.put(v[i]);
}

/// Of x, y, z and turns about x, y, z. Objects stand on the table: about x and y they do not turn.
std::array<double, 36> six_by_six(const std::array<double, 16>& given) {
  constexpr std::array<std::size_t, 4> place{0, 1, 2, 5};
  std::array<double, 36> made{};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j) made[6 * place[i] + place[j]] = given[4 * i + j];
  return made;
}

}  // namespace

ros2::Bytes detections_message(std::int64_t stamp_ns, std::string_view frame,
                               const std::vector<Detection>& detections) {
  ros2::CdrWriter made;
  put_header(made, stamp_ns, frame);
  made.put(static_cast<std::uint32_t>(detections.size()));
  for (const Detection& one : detections) {
    put_header(made, one.stamp_ns, frame);
    made.put(std::uint32_t{1});  // one hypothesis
    made.put(one.name);
    made.put(one.probability);
    made.put(one.X_WO);
    made.put(six_by_six(one.covariance));
    made.put(one.X_WO);
    put(made, one.size);
    made.put(std::to_string(one.track));
  }
  return std::move(made).bytes();
}

}  // namespace prehend::ros
