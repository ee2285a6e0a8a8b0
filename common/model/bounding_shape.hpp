#pragma once

#include "common/model/mesh.hpp"
#include "common/model/shape.hpp"

namespace prehend::model {

/// Of the boxes, spheres, upright cylinders and cones about the middle of bounds(mesh) that hold
/// the whole mesh, the one of least volume; a box unless another is clearly smaller.
Shape bounding_shape(const Mesh& mesh);

}  // namespace prehend::model
