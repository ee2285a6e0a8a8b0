#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "common/model/catalogue.hpp"

namespace prehend::recognition {

/// A painted face of an object: albedo (linear RGB, 0..1) on a grid of `texel` metres.
struct Face {
  int width = 0, height = 0;  // texels
  std::vector<Eigen::Vector3f> albedo;
  /// Nearest texel at u (right) and v (up), both 0..1, clamped.
  const Eigen::Vector3f& at(double u, double v) const;
};

/// All faces of an object. Cylinder: side, top. Box: +x, +y, -x, -y, top; a side's u runs to the
/// right as seen from outside, v up.
struct Texture {
  std::vector<Face> faces;
};

/// Paints an object as its catalogue entry says; the same entry gives the same picture.
Texture paint(const model::CatalogueObject& object);

/// sRGB to linear light and back, 0..1.
float to_linear(float srgb);
float to_srgb(float linear);

/// Smooth noise in [-1, 1] over the plane, with features of about one unit.
double value_noise(double x, double y, std::uint64_t seed);

}  // namespace prehend::recognition
