#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <vector>

#include "common/base/error.hpp"

namespace prehend::model {

/// A closed surface of triangles, whose corners are counterclockwise seen from outside. m.
struct Mesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> triangles;  // numbers of vertices
};

/// The solid inside a mesh, of uniform density.
struct Solid {
  double volume = 0;        // m³
  Eigen::Vector3d centre;   // of mass, in the mesh's frame, m
  Eigen::Matrix3d inertia;  // about the centre, along the mesh's axes, per kg: m²
};

/// Reads STL or OBJ; scale: metres per unit of the file. All parts become one mesh and equal
/// vertices one; a mesh that is inside out is turned. Fails on what is unreadable, not finite,
/// empty, larger than 200,000 triangles, or not closed.
Expected<Mesh> load_mesh(const std::filesystem::path& file, double scale = 1);

/// Volume integrals over the surface (Mirtich 1996, by tetrahedra from the origin). Fails when an
/// edge is not shared by two triangles that run along it in opposite directions, or when the mesh
/// encloses no volume.
Expected<Solid> measure(const Mesh& mesh);

/// The same mesh, its vertices moved.
Mesh moved(Mesh mesh, const Eigen::Vector3d& by);

/// The box that bounds it along its axes, m. The mesh has vertices.
Eigen::AlignedBox3d bounds(const Mesh& mesh);

}  // namespace prehend::model
