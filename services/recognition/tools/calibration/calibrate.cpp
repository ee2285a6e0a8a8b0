#include "services/recognition/tools/calibration/calibrate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/calib3d.hpp>

namespace prehend::recognition {
namespace {

std::vector<cv::Point3f> corners_B(const Chessboard& board) {
  std::vector<cv::Point3f> made;
  for (int row = 0; row < board.rows; ++row)
    for (int column = 0; column < board.columns; ++column)
      made.push_back(
          {static_cast<float>(column * board.square), static_cast<float>(row * board.square), 0});
  return made;
}

std::vector<cv::Point2f> to_cv(const BoardView& view) {
  std::vector<cv::Point2f> made;
  for (const Eigen::Vector2d& p : view)
    made.push_back({static_cast<float>(p.x()), static_cast<float>(p.y())});
  return made;
}

double coverage(const std::vector<BoardView>& views, int width, int height) {
  constexpr int across = 5, down = 4;
  std::array<bool, across * down> seen{};
  for (const BoardView& view : views)
    for (const Eigen::Vector2d& p : view) {
      const int x = std::clamp(static_cast<int>(p.x() * across / width), 0, across - 1);
      const int y = std::clamp(static_cast<int>(p.y() * down / height), 0, down - 1);
      seen[static_cast<std::size_t>(y * across + x)] = true;
    }
  return static_cast<double>(std::count(seen.begin(), seen.end(), true)) / (across * down);
}

/// One round over some of the views.
struct Round {
  cv::Mat matrix, distortion, intrinsic_sigma, errors;
  double residual = 0;
};

std::optional<Round> solve(const std::vector<BoardView>& views, const std::vector<std::size_t>& use,
                           const Chessboard& board, int width, int height) {
  std::vector<std::vector<cv::Point3f>> objects;
  std::vector<std::vector<cv::Point2f>> pictures;
  for (const std::size_t i : use) {
    objects.push_back(corners_B(board));
    pictures.push_back(to_cv(views[i]));
  }
  Round round;
  cv::Mat turns, shifts, extrinsic_sigma;
  try {
    round.residual = cv::calibrateCamera(objects, pictures, {width, height}, round.matrix,
                                         round.distortion, turns, shifts, round.intrinsic_sigma,
                                         extrinsic_sigma, round.errors, cv::CALIB_FIX_K3);
  } catch (const cv::Exception&) {
    return std::nullopt;
  }
  if (!std::isfinite(round.residual)) return std::nullopt;
  return round;
}

cv::Mat matrix_of(const CameraModel& camera) {
  return (cv::Mat_<double>(3, 3) << camera.focal.x(), 0, camera.centre.x(), 0, camera.focal.y(),
          camera.centre.y(), 0, 0, 1);
}

std::string numbers(const std::vector<double>& values, int digits) {
  std::string made = "[";
  for (const double value : values)
    made += fmt::format("{}{:.{}f}", made.size() > 1 ? ", " : "", value, digits);
  return made + ']';
}

}  // namespace

Expected<Calibrated> calibrate(const std::vector<BoardView>& views, const Chessboard& board,
                               int width, int height) {
  constexpr std::size_t least = 5;
  if (const auto good = checked_board(board); !good) return tl::unexpected(good.error());
  for (const BoardView& view : views)
    if (view.size() != static_cast<std::size_t>(board.columns * board.rows))
      return fail("a view has not the board's number of corners", "calibration");
  if (views.size() < least)
    return fail(fmt::format("the board is wholly in sight in {} pictures, {} are needed",
                            views.size(), least),
                "calibration", "show it near and far, in every corner, slanted each way");
  std::vector<std::size_t> use(views.size());
  for (std::size_t i = 0; i < use.size(); ++i) use[i] = i;
  auto round = solve(views, use, board, width, height);
  Calibrated made;
  made.errors.assign(views.size(), -1);
  if (round) {
    std::vector<double> sorted(round->errors.begin<double>(), round->errors.end<double>());
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<long>(sorted.size() / 2),
                     sorted.end());
    const double limit = std::max(0.5, 3 * sorted[sorted.size() / 2]);
    std::vector<std::size_t> good;
    for (std::size_t i = 0; i < use.size(); ++i)
      if (round->errors.at<double>(static_cast<int>(i)) <= limit) good.push_back(i);
    if (good.size() < use.size() && good.size() >= least) {
      use = good;
      round = solve(views, use, board, width, height);
    }
  }
  if (!round) return fail("the views do not determine a camera", "calibration", "take others");
  for (std::size_t i = 0; i < use.size(); ++i)
    made.errors[use[i]] = round->errors.at<double>(static_cast<int>(i));
  made.residual = round->residual;
  made.camera.width = width;
  made.camera.height = height;
  made.camera.focal = {round->matrix.at<double>(0, 0), round->matrix.at<double>(1, 1)};
  made.camera.centre = {round->matrix.at<double>(0, 2), round->matrix.at<double>(1, 2)};
  for (int i = 0; i < 5; ++i)
    made.camera.distortion[static_cast<std::size_t>(i)] =
        i < static_cast<int>(round->distortion.total()) ? round->distortion.at<double>(i) : 0;
  made.focal_sigma = {round->intrinsic_sigma.at<double>(0), round->intrinsic_sigma.at<double>(1)};
  made.centre_sigma = {round->intrinsic_sigma.at<double>(2), round->intrinsic_sigma.at<double>(3)};
  made.covered = coverage(views, width, height);
  if (!(made.focal_sigma.maxCoeff() < 0.05 * made.camera.focal.minCoeff()))
    return fail("the focal length stays open by more than 5 %", "calibration",
                "slant the board by 30 to 45 degrees, each way");
  const auto checked = checked_camera(made.camera);
  if (!checked) return tl::unexpected(checked.error());
  return made;
}

Expected<CameraPlace> locate_camera(const CameraModel& camera, const BoardView& view,
                                    const Chessboard& board, const TablePose& lying) {
  if (const auto good = checked_board(board); !good) return tl::unexpected(good.error());
  const auto objects = corners_B(board);
  if (view.size() != objects.size())
    return fail("the view has not the board's number of corners", "calibration");
  const cv::Mat distortion(1, 5, CV_64F, const_cast<double*>(camera.distortion.data()));
  cv::Vec3d turn, shift;
  cv::Mat R;
  bool found = false;
  try {
    found = cv::solvePnP(objects, to_cv(view), matrix_of(camera), distortion, turn, shift, false,
                         cv::SOLVEPNP_IPPE) &&
            cv::solvePnP(objects, to_cv(view), matrix_of(camera), distortion, turn, shift, true,
                         cv::SOLVEPNP_ITERATIVE);
    cv::Rodrigues(turn, R);
  } catch (const cv::Exception&) {
    found = false;
  }
  if (!found)
    return fail("the board's place cannot be found", "calibration", "take another picture");
  Eigen::Matrix3d R_CB;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) R_CB(i, j) = R.at<double>(i, j);
  const Pose X_CB = make_pose({shift[0], shift[1], shift[2]}, R_CB);
  // Lying on its back, the board's z points into the table.
  const Eigen::Matrix3d R_WB = (Eigen::AngleAxisd(lying.yaw, Eigen::Vector3d::UnitZ()) *
                                Eigen::AngleAxisd(std::acos(-1.0), Eigen::Vector3d::UnitX()))
                                   .toRotationMatrix();
  const Pose X_WB = make_pose({lying.x, lying.y, 0}, R_WB);
  CameraPlace made;
  made.X_WC = X_WB * X_CB.inverse();
  CameraModel placed = camera;
  placed.X_WC = made.X_WC;
  double squares = 0, metres = 0;
  for (std::size_t i = 0; i < view.size(); ++i) {
    const Eigen::Vector3d p_W = X_WB * Eigen::Vector3d(objects[i].x, objects[i].y, 0);
    const auto pixel = placed.project(p_W);
    const auto on_table = placed.on_level(view[i], 0);
    if (!pixel || !on_table || made.X_WC.translation().z() <= 0)
      return fail("the camera would look from below the table", "calibration",
                  "the printed side must lie up");
    squares += (*pixel - view[i]).squaredNorm();
    metres += (*on_table - p_W).squaredNorm();
  }
  made.residual = std::sqrt(squares / static_cast<double>(view.size()));
  made.on_table = std::sqrt(metres / static_cast<double>(view.size()));
  return made;
}

std::vector<std::pair<std::string, std::string>> camera_lines(const CameraModel& camera) {
  const Eigen::Vector3d p = camera.X_WC.translation();
  const Eigen::Quaterniond q(camera.X_WC.linear());
  const auto& k = camera.distortion;
  std::vector<std::pair<std::string, std::string>> made{
      {"width", fmt::format("{}", camera.width)},
      {"height", fmt::format("{}", camera.height)},
      {"focal", numbers({camera.focal.x(), camera.focal.y()}, 3)},
      {"centre", numbers({camera.centre.x(), camera.centre.y()}, 3)},
      {"distortion", numbers({k.begin(), k.end()}, 6)},
      {"X_WC", numbers({p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()}, 6)}};
  for (auto& [key, value] : made) value = key + " = " + value;
  return made;
}

}  // namespace prehend::recognition
