#pragma once

#include "services/recognition/core/geometry/camera_model.hpp"
#include "services/recognition/core/geometry/silhouette.hpp"
#include "services/recognition/tools/calibration/chessboard.hpp"

namespace prehend::recognition {

/// The inner corners of the board in one picture, px, in the board's order.
using BoardView = std::vector<Eigen::Vector2d>;

struct Calibrated {
  CameraModel camera;                                           // X_WC is left as it was given
  double residual = 0;                                          // px, RMS of all corners
  Eigen::Vector2d focal_sigma = {0, 0}, centre_sigma = {0, 0};  // px, standard deviations
  std::vector<double> errors;  // px, RMS of each view; negative for one that was left out
  double covered = 0;          // share of the picture's 5 by 4 fields in which a corner was seen
};

/// Focal length, principal point and distortion (k1, k2, p1, p2; k3 stays 0) from views of the
/// board in different places and slants (Zhang 2000, as OpenCV has it). A view whose error is above
/// 3 times the median and above half a pixel is left out. Fails with fewer than 5 views and when
/// they show the board from nearly the same side, which leaves the focal length open.
Expected<Calibrated> calibrate(const std::vector<BoardView>& views, const Chessboard& board,
                               int width, int height);

struct CameraPlace {
  Pose X_WC = Pose::Identity();
  double residual = 0;  // px, RMS
  double on_table = 0;  // m, RMS distance on the table between where corners are and are seen
};

/// Where the camera stands, from one view of the board lying on the table, printed side up, its
/// first inner corner at (x, y) and its rows turned by yaw about the vertical.
Expected<CameraPlace> locate_camera(const CameraModel& camera, const BoardView& view,
                                    const Chessboard& board, const TablePose& lying);

/// The lines of lab.toml's table [camera]: key and «key = value».
std::vector<std::pair<std::string, std::string>> camera_lines(const CameraModel& camera);

}  // namespace prehend::recognition
