#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "services/planner/tools/hand_import/mjcf_source.hpp"

namespace prehend::planner {

/// A <mesh> of <asset>.
struct MjcfMesh {
  std::string file;                       // as written; empty: it has vertices
  std::vector<Eigen::Vector3d> vertices;  // scaled, m
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
  Pose X_MV = Pose::Identity();  // V: frame in which the file gives vertices; M: the mesh's
};
using MjcfMeshes = std::map<std::string, MjcfMesh>;

MjcfMeshes read_meshes(MjcfSource& source);

/// A <geom> as solids, in the frame B of its body.
struct MjcfGeom {
  std::vector<Solid> solids;
  bool touches = true;  // anything at all
  int group = 0;
  std::optional<double> mass;  // kg, if it is given
  Inertial inertial_B;         // of that mass; of a mesh without moments
};

/// None for what has no shape of its own, such as a plane of the world; elsewhere that is a
/// finding. pairs: names of geoms that touch by <pair>. X_BF: the frame that it stands in.
std::optional<MjcfGeom> read_geom(MjcfSource& source, const MjcfElement& geom, const Pose& X_BF,
                                  const MjcfMeshes& meshes, const std::set<std::string>& pairs);

/// Sorts geoms of one body into what collides and what is only seen.
void add_geoms(const std::vector<MjcfGeom>& geoms, RobotLink& link);

/// The sum of the masses that are given; none if none is.
std::optional<Inertial> given_mass(const std::vector<MjcfGeom>& geoms);

}  // namespace prehend::planner
