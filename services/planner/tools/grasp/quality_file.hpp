#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/analysis/contact.hpp"
#include "common/base/error.hpp"
#include "common/base/pose.hpp"
#include "common/model/shape.hpp"

namespace prehend::planner {

/// A hand in its grasp.
struct HandPlace {
  std::string name;
  Eigen::VectorXd joints;  // rad or m
  Pose X_OB = Pose::Identity();
};

/// A grasp as a file for `prehend grasp quality` describes it. O: axes of the file, origin at the
/// centre of mass.
struct GraspFile {
  Eigen::MatrixXd wrenches;                 // columns of six: given, or of the contacts
  std::vector<analysis::Contact> contacts;  // empty when the file gives wrenches alone
  double torque_scale = 1;                  // m
  int edges = 8;
  std::optional<Eigen::Matrix<double, 6, 1>> load_O;  // N, N m, that acts on the object
  std::optional<Eigen::Vector3d> approach_O;
  std::optional<model::Shape> shape;
  std::optional<HandPlace> hand;  // then contacts name its links
};

/// Reads {"wrenches":[[6]...]}, or {"contacts":[{"position_m","normal","friction","torsion_m"?,
/// "tangent"?,"link"?}],"center_of_mass_m"?,"torque_scale_m","edges"?,"load"?,"approach"?,
/// "shape"?:{"kind","size_m"}}, or both, as `prehend grasp export --index` writes it with "hand",
/// "joints" and "X_OB":{"position_m","orientation_wxyz"}. Errors name the file and the entry.
Expected<GraspFile> read_grasp(const std::filesystem::path& file);

}  // namespace prehend::planner
