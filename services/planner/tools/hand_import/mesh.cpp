#include "services/planner/tools/hand_import/mesh.hpp"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <assimp/Importer.hpp>
#include <fstream>
#include <map>
#include <memory>
#include <numbers>

namespace prehend::planner {
namespace {

using Eigen::Vector3d;
using std::filesystem::path;

constexpr double thinnest = 0.001;  // m

void collect(const aiScene& scene, const aiNode& node, const aiMatrix4x4& above,
             std::vector<Vector3d>& points) {
  const aiMatrix4x4 X = above * node.mTransformation;
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[m]];
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D p = X * mesh.mVertices[v];
      points.emplace_back(p.x, p.y, p.z);
    }
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c) collect(scene, *node.mChildren[c], X, points);
}

/// What no reader of meshes would name: an empty file, or the stand-in of one that was not fetched.
Expected<void> is_there(const path& file) {
  constexpr std::string_view pointer = "version https://git-lfs.github.com/spec/";
  std::string beginning(pointer.size(), ' ');
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return fail("cannot be read", file.string(), "may you read it?");
  stream.read(beginning.data(), static_cast<std::streamsize>(beginning.size()));
  if (stream.gcount() == 0) return fail("is empty", file.string(), "fetch the file again");
  if (beginning == pointer)
    return fail("is a Git LFS pointer, not the mesh itself", file.string(), "git lfs pull");
  return {};
}

Expected<std::vector<Vector3d>> read_mesh(const path& file) {
  if (const auto there = is_there(file); !there) return tl::unexpected(there.error());
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene =
      importer.ReadFile(file.string(), aiProcess_JoinIdenticalVertices | aiProcess_Triangulate);
  if (!scene || !scene->mRootNode)
    return fail("is no mesh that can be read", file.string(), importer.GetErrorString());
  std::vector<Vector3d> points;
  collect(*scene, *scene->mRootNode, aiMatrix4x4(), points);
  if (points.empty() ||
      !std::all_of(points.begin(), points.end(), [](const Vector3d& p) { return p.allFinite(); }))
    return fail("has no vertices, or some that are not finite", file.string(), "export it again");
  return points;
}

/// A rotation whose columns are the principal axes of the points.
Eigen::Matrix3d principal_axes(const std::vector<Vector3d>& points) {
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& p : points) mean += p / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vector3d& p : points) spread += (p - mean) * (p - mean).transpose();
  Eigen::Matrix3d R = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors();
  if (R.determinant() < 0) R.col(0) = -R.col(0);
  return R;
}

}  // namespace

MeshReader mesh_files(const path& robot_file, const Packages& packages) {
  // Places are looked for once: folders of others are large, and some meshes are in none of them.
  using Places = std::map<std::pair<std::string, std::string>, Expected<path>>;
  const auto places = std::make_shared<Places>();
  return [=](const Solid& solid) -> Expected<std::vector<Vector3d>> {
    const std::pair name(solid.mesh_folder, solid.mesh);
    auto known = places->find(name);
    if (known == places->end())
      known = places->emplace(name, find_mesh(solid, robot_file, packages)).first;
    const Expected<path>& file = known->second;
    if (!file) return tl::unexpected(file.error());
    auto points = read_mesh(*file);
    if (points)
      for (Vector3d& p : *points) p = p.cwiseProduct(solid.scale);
    return points;
  };
}

Solid fit_primitive(const std::vector<Vector3d>& points) {
  Solid best;
  double least = std::numeric_limits<double>::infinity();
  const auto offer = [&](const model::Shape& shape, const Pose& X_SF) {
    // A box is preferred unless another is clearly smaller.
    const double size = model::volume(shape) * (shape.kind == model::ShapeKind::box ? 1.0 : 1.02);
    if (!(size < least)) return;
    least = size;
    best.shape = shape;
    best.X_LS = X_SF;
  };
  const Eigen::Matrix3d own = Eigen::Matrix3d::Identity();
  for (const Eigen::Matrix3d& R : {own, principal_axes(points)}) {
    Vector3d low = R.transpose() * points[0], high = low;
    for (const Vector3d& p : points) {
      low = low.cwiseMin(R.transpose() * p);
      high = high.cwiseMax(R.transpose() * p);
    }
    const Vector3d size = (high - low).cwiseMax(thinnest), middle = 0.5 * (high + low);
    offer({model::ShapeKind::box, size}, make_pose(R * middle, R));
    double sphere = 0.5 * thinnest;
    for (const Vector3d& p : points) sphere = std::max(sphere, (p - R * middle).norm());
    offer({model::ShapeKind::sphere, Vector3d::Constant(sphere)}, make_pose(R * middle));
    for (int axis = 0; axis < 3; ++axis) {
      Eigen::Matrix3d turned;  // z along the axis
      for (int k = 0; k < 3; ++k) turned.col(k) = R.col((axis + 1 + k) % 3);
      double radius = 0.5 * thinnest;
      for (const Vector3d& p : points)
        radius = std::max(radius, (turned.transpose() * (p - R * middle)).head<2>().norm());
      offer({model::ShapeKind::cylinder, {radius, radius, size[axis]}},
            make_pose(R * middle, turned));
    }
  }
  return best;
}

}  // namespace prehend::planner
