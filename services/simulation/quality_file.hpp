#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <prehend/analysis/contact.hpp>
#include <prehend/base/error.hpp>
#include <prehend/model/shape.hpp>
#include <vector>

namespace prehend::simulation {

/// A grasp as a file for `prehend grasp quality` describes it. O: axes of the file, origin at the
/// centre of mass.
struct GraspFile {
  Eigen::MatrixXd wrenches;                 // columns of six
  std::vector<analysis::Contact> contacts;  // empty when the file gives wrenches
  double torque_scale = 1;                  // m
  int edges = 8;
  std::optional<Eigen::Matrix<double, 6, 1>> load_O;  // N, N m, that acts on the object
  std::optional<Eigen::Vector3d> approach_O;
  std::optional<model::Shape> shape;
};

/// Reads either {"wrenches":[[6]...]} or {"contacts":[{"position_m","normal","friction",
/// "torsion_m"?,"tangent"?}],"center_of_mass_m"?,"torque_scale_m","edges"?,"load"?,"approach"?,
/// "shape"?:{"kind","size_m"}}. Errors name the file and the entry.
Expected<GraspFile> read_grasp(const std::filesystem::path& file);

}  // namespace prehend::simulation
