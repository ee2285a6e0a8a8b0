#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/base/pose.hpp"
#include "services/planner/tools/picture/solid.hpp"

namespace prehend::planner {

/// How a surface looks.
struct Paint {
  Eigen::Vector3d colour;  // sRGB, 0..1
  double gloss = 0.2;      // strength of its highlight
  double opacity = 1;      // below 1, what lies behind the nearest such surface shows through
  double glow = 0;         // share of its colour that no light or shadow changes
};

/// A pinhole camera with square pixels whose z axis looks ahead and whose y axis points down.
struct Viewpoint {
  Pose X_WV = Pose::Identity();
  double width = 0.7;  // of the picture at unit distance
};

/// Colours row by row, sRGB, 8 bits a channel.
struct Raster {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

/// Surfaces above a floor, lit by one lamp and the sky. W: z up.
struct Drawing {
  std::vector<Triangle> triangles;
  std::vector<Paint> paints;
  double floor = 0;  // its height in W, m

  /// By z-buffer, `samples` times `samples` of them a pixel, with shadows from a depth map as the
  /// lamp sees it, and thin dark lines where surfaces meet. All triangles must lie before the
  /// camera.
  Raster draw(const Viewpoint& view, int width, int height, int samples = 3) const;

  /// How many pixels each paint covers, also behind what can be seen through.
  std::vector<int> coverage(const Viewpoint& view, int width, int height) const;
};

}  // namespace prehend::planner
