#include "common/model/mesh.hpp"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cmath>
#include <map>
#include <utility>

namespace prehend::model {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::size_t max_triangles = 200000;

/// Adds the triangles of a node and all below it, with equal vertices merged.
class Collector {
 public:
  explicit Collector(double scale) : scale_(scale) {}

  void add(const aiScene& scene, const aiNode& node, const aiMatrix4x4& parent) {
    const aiMatrix4x4 transform = parent * node.mTransformation;
    for (unsigned i = 0; i < node.mNumMeshes; ++i) add(*scene.mMeshes[node.mMeshes[i]], transform);
    for (unsigned i = 0; i < node.mNumChildren; ++i) add(scene, *node.mChildren[i], transform);
  }

  Mesh mesh;

 private:
  void add(const aiMesh& part, const aiMatrix4x4& transform) {
    for (unsigned i = 0; i < part.mNumFaces; ++i) {
      const aiFace& face = part.mFaces[i];
      if (face.mNumIndices != 3) continue;  // points and lines
      Eigen::Vector3i triangle;
      for (int k = 0; k < 3; ++k)
        triangle[k] = vertex(transform * part.mVertices[face.mIndices[k]]);
      if (triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0])
        mesh.triangles.push_back(triangle);
    }
  }

  int vertex(const aiVector3D& p) {
    const auto [found, is_new] =
        numbers_.try_emplace({p.x, p.y, p.z}, static_cast<int>(mesh.vertices.size()));
    if (is_new) mesh.vertices.emplace_back(scale_ * Vector3d(p.x, p.y, p.z));
    return found->second;
  }

  double scale_;
  std::map<std::array<ai_real, 3>, int> numbers_;
};

double signed_volume(const Mesh& mesh) {
  double sum = 0;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const auto corner = [&](int k) -> const Vector3d& {
      return mesh.vertices[static_cast<std::size_t>(t[k])];
    };
    sum += corner(0).dot(corner(1).cross(corner(2))) / 6;
  }
  return sum;
}

/// Every edge is run along once in each direction.
bool is_closed(const Mesh& mesh) {
  std::map<std::pair<int, int>, int> edges;
  for (const Eigen::Vector3i& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
  return std::all_of(edges.begin(), edges.end(), [&](const auto& edge) {
    const auto back = edges.find({edge.first.second, edge.first.first});
    return back != edges.end() && back->second == edge.second;
  });
}

}  // namespace

Expected<Mesh> load_mesh(const std::filesystem::path& file, double scale) {
  if (!(scale > 0) || !std::isfinite(scale)) return fail("scale must be positive", file.string());
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension != ".stl" && extension != ".obj")
    return fail("is neither STL nor OBJ", file.string());
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(file.string(), aiProcess_Triangulate);
  if (!scene || !scene->mRootNode)
    return fail("cannot be read: " + std::string(importer.GetErrorString()), file.string());
  Collector collector(scale);
  collector.add(*scene, *scene->mRootNode, aiMatrix4x4());
  Mesh mesh = std::move(collector.mesh);
  if (mesh.triangles.empty()) return fail("has no triangles", file.string());
  if (mesh.triangles.size() > max_triangles)
    return fail("has more than 200,000 triangles", file.string(), "simplify it");
  for (const Vector3d& vertex : mesh.vertices)
    if (!vertex.allFinite() || vertex.norm() > 10)
      return fail("has vertices that are not finite or more than 10 m away", file.string(),
                  "check the scale: files are often in millimetres");
  if (signed_volume(mesh) < 0)
    for (Eigen::Vector3i& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  if (const auto solid = measure(mesh); !solid)
    return fail(solid.error().what, file.string(), solid.error().hint);
  return mesh;
}

Expected<Solid> measure(const Mesh& mesh) {
  if (!is_closed(mesh)) return fail("mesh is not closed", {}, "close its holes");
  Solid solid;
  Vector3d first = Vector3d::Zero();   // ∫ x dV
  Matrix3d second = Matrix3d::Zero();  // ∫ x xᵀ dV
  Vector3d least = mesh.vertices.front(), most = least;
  for (const Vector3d& vertex : mesh.vertices) {
    least = least.cwiseMin(vertex);
    most = most.cwiseMax(vertex);
  }
  const Vector3d origin = 0.5 * (least + most);  // near the solid, for the sake of precision
  for (const Eigen::Vector3i& t : mesh.triangles) {
    Matrix3d corners;
    for (int k = 0; k < 3; ++k)
      corners.col(k) = mesh.vertices[static_cast<std::size_t>(t[k])] - origin;
    const double six_volumes = corners.determinant();
    const Vector3d sum = corners.rowwise().sum();
    solid.volume += six_volumes / 6;
    first += six_volumes / 24 * sum;
    second += six_volumes / 120 * (corners * corners.transpose() + sum * sum.transpose());
  }
  if (!(solid.volume > 1e-9 * (most - least).prod()) || !std::isfinite(solid.volume))
    return fail("mesh encloses no volume");
  const Vector3d centre = first / solid.volume;
  solid.centre = origin + centre;
  const Matrix3d covariance = second / solid.volume - centre * centre.transpose();
  solid.inertia = covariance.trace() * Matrix3d::Identity() - covariance;
  return solid;
}

Eigen::AlignedBox3d bounds(const Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& vertex : mesh.vertices) box.extend(vertex);
  return box;
}

Mesh moved(Mesh mesh, const Vector3d& by) {
  for (Vector3d& vertex : mesh.vertices) vertex += by;
  return mesh;
}

}  // namespace prehend::model
