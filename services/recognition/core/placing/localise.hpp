#pragma once

#include <optional>

#include "services/recognition/core/geometry/silhouette.hpp"
#include "services/recognition/core/placing/fitting_image.hpp"

namespace prehend::recognition {

struct Fit {
  TablePose at;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // of x, y (m), yaw (rad)
  Silhouette region;
  Plane visible;      // 1: pixels of the region that show this object and nothing before it
  double hidden = 0;  // share of the region that something unknown stands before
  /// How well the picture agrees with that outline, 0..1: overlap (intersection over union) of the
  /// region with what looks like the object nearby, by the learned colours and by the picture's
  /// own.
  double agreement = 0;
  /// Width and height measured in the picture, through the table's plane, as shares of those that
  /// the shape has.
  Eigen::Vector2d measured = {1, 1};
  double contrast = 0.5;  // share of the outline along which the picture's colours change
};

/// Finds where a shape that stands on the table near (x, y) covers the picture best: the sum over
/// its silhouette of the log likelihood ratio of object against surroundings is greatest. The ratio
/// starts from the colours that were learned and is then re-estimated twice from the picture
/// itself, inside against around (as region-based trackers do), so that it follows light and table.
/// `known_colours`: share of each palette colour on the object. `reach`: how far from (x, y) to
/// look, m. None when the shape is out of the picture.
std::optional<Fit> localise(const FittingImage& frame, const CameraModel& camera,
                            const model::Shape& shape, const Eigen::VectorXf& known_colours,
                            double x, double y, double reach = 0.06);

}  // namespace prehend::recognition
