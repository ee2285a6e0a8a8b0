#include "services/planner/tools/hand_import/mjcf_geom.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "services/planner/tools/hand_import/mesh.hpp"

namespace prehend::planner {
namespace {

using Eigen::Vector3d;
using tinyxml2::XMLElement;

constexpr int first_collision_group = 3;  // by custom, where contacts do not tell
constexpr std::size_t vertices_at_most = 1'000'000;

std::string without_extension(std::string file) {
  file = file.substr(file.rfind('/') + 1);  // npos + 1 is 0
  return file.substr(0, file.rfind('.'));
}

/// Solids and mass of one geom.
class GeomReader {
 public:
  GeomReader(MjcfSource& source, const MjcfElement& geom, const Pose& X_BF)
      : source_(source), geom_(geom), X_BG_(X_BF * source.pose(geom)), X_BF_(X_BF) {
    kind_ = geom.text_or("type", "sphere");
    line_ = geom.at->GetLineNum();
  }

  std::optional<MjcfGeom> read(const MjcfMeshes& meshes, const std::set<std::string>& pairs) {
    made_.touches = source_.number(geom_, "contype", 1) != 0 ||
                    source_.number(geom_, "conaffinity", 1) != 0 ||
                    pairs.contains(geom_.text_or("name", ""));
    made_.group = static_cast<int>(std::clamp(source_.number(geom_, "group", 0), 0.0, 100.0));
    if (kind_ == "mesh" || geom_.text("mesh")) {
      if (!add_mesh(meshes)) return std::nullopt;
    } else if (!add_primitive()) {
      return std::nullopt;
    }
    weigh();
    return std::move(made_);
  }

 private:
  Severity severity() const { return made_.touches ? Severity::error : Severity::warning; }

  void add(const model::Shape& shape, const Pose& X_GS) {
    Solid solid;
    solid.shape = shape;
    solid.X_LS = X_BG_ * X_GS;
    solid.line = line_;
    made_.solids.push_back(std::move(solid));
  }

  bool add_mesh(const MjcfMeshes& meshes) {
    const std::string name = geom_.text_or("mesh", "");
    const auto found = meshes.find(name);
    if (found == meshes.end()) {
      source_.complain(severity(), "missing-mesh", *geom_.at,
                       fmt::format("shows the mesh \"{}\", which no <asset> has", name),
                       "add <mesh name file/> to <asset>");
      return false;
    }
    const MjcfMesh& mesh = found->second;
    Solid solid;
    if (mesh.file.empty())
      solid = fit_primitive(mesh.vertices);
    else
      solid.mesh = mesh.file;
    solid.mesh_folder = source_.compiler().mesh_folder;
    solid.scale = mesh.scale;
    solid.X_LS = X_BG_ * mesh.X_MV * solid.X_LS;
    solid.line = line_;
    made_.solids.push_back(std::move(solid));
    return true;
  }

  bool add_primitive() {
    const bool flat = kind_ == "plane" || kind_ == "hfield" || kind_ == "sdf";
    const bool known = kind_ == "sphere" || kind_ == "box" || kind_ == "ellipsoid" || is_long();
    if (flat || !known) {
      source_.complain(severity(), "unknown-geometry", *geom_.at,
                       fmt::format("a {} is no shape of a hand and would be dropped", kind_),
                       "use boxes, cylinders, capsules, spheres or a mesh");
      return false;
    }
    if (!read_size()) return false;
    const double r = half_[0], h = half_[2];
    if (kind_ == "sphere") {
      add({model::ShapeKind::sphere, Vector3d::Constant(r)}, Pose::Identity());
    } else if (kind_ == "box") {
      add({model::ShapeKind::box, 2 * half_}, Pose::Identity());
    } else if (kind_ == "ellipsoid") {
      add_ellipsoid();
    } else {
      add({model::ShapeKind::cylinder, {r, r, 2 * h}}, Pose::Identity());
      if (kind_ == "cylinder") return true;
      for (const double end : {-h, h})
        add({model::ShapeKind::sphere, Vector3d::Constant(r)}, make_pose(Vector3d(0, 0, end)));
    }
    return true;
  }

  bool is_long() const { return kind_ == "capsule" || kind_ == "cylinder"; }

  /// Half sizes along G; of what is long radius, radius, half length.
  bool read_size() {
    const auto size = source_.numbers(geom_, "size", 1, 3);
    const auto ends = kind_ == "sphere" ? std::nullopt : source_.numbers(geom_, "fromto", 6, 6);
    const std::size_t needed = kind_ == "sphere" || ends ? 1 : is_long() ? 2 : 3;
    bool good = size && size->size() >= needed;
    if (good && needed == 3) half_ = Vector3d(size->data());
    if (good && needed < 3) half_ = Vector3d((*size)[0], (*size)[0], (*size)[needed - 1]);
    if (good && ends) {
      const Vector3d from(ends->data()), way = Vector3d(ends->data() + 3) - from;
      half_[2] = 0.5 * way.norm();
      if (way.norm() > 1e-9)
        X_BG_ = X_BF_ * make_pose(from + 0.5 * way,
                                  Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), way));
    }
    good = good && half_.minCoeff() > 0;
    if (!good)
      source_.complain(severity(), "bad-size", *geom_.at,
                       fmt::format("a {} without a positive size", kind_),
                       "sizes are positive half lengths, in metres");
    return good;
  }

  void add_ellipsoid() {
    std::vector<Vector3d> points;
    for (int i = 0; i < 24; ++i)
      for (int k = 0; k <= 12; ++k) {
        const double a = i * std::numbers::pi / 12, b = k * std::numbers::pi / 12;
        points.push_back(half_.cwiseProduct(
            Vector3d(std::cos(a) * std::sin(b), std::sin(a) * std::sin(b), std::cos(b))));
      }
    const Solid fitted = fit_primitive(points);
    add(fitted.shape, fitted.X_LS);
    if (made_.touches)
      source_.complain(Severity::warning, "ellipsoid", *geom_.at, "collides as an ellipsoid",
                       fmt::format("taken as the {} around it", to_string(fitted.shape.kind)));
  }

  void weigh() {
    if (!geom_.text("mass")) return;
    const double mass = source_.number(geom_, "mass", 0);
    if (mass < 0) {
      source_.complain(Severity::error, "no-mass", *geom_.at,
                       fmt::format("a geom has a mass of {} kg", mass), "give its mass in kg");
      return;
    }
    made_.mass = mass;
    made_.inertial_B.mass = mass;
    made_.inertial_B.X_LI = X_BG_;
    if (kind_ != "mesh" && !geom_.text("mesh"))
      made_.inertial_B.inertia_I = (mass * moments()).asDiagonal();
  }

  /// Principal moments of 1 kg of the shape along G, m².
  Vector3d moments() const {
    const Vector3d square = half_.cwiseAbs2();
    const Vector3d others = Vector3d::Constant(square.sum()) - square;
    if (kind_ == "box") return others / 3;
    if (kind_ == "ellipsoid") return others / 5;
    const double r = half_[0], length = 2 * half_[2];
    if (kind_ == "sphere") return Vector3d::Constant(0.4 * r * r);
    const double ends = kind_ == "capsule" ? 4 * r / (4 * r + 3 * length) : 0, middle = 1 - ends;
    const double across = middle * (length * length / 12 + r * r / 4) +
                          ends * (0.4 * r * r + length * length / 4 + 3 * length * r / 8);
    return {across, across, middle * r * r / 2 + ends * 0.4 * r * r};
  }

  MjcfSource& source_;
  const MjcfElement& geom_;
  Pose X_BG_;
  const Pose& X_BF_;
  std::string kind_;
  int line_ = 0;
  Vector3d half_ = Vector3d::Zero();
  MjcfGeom made_;
};

}  // namespace

MjcfMeshes read_meshes(MjcfSource& source) {
  MjcfMeshes meshes;
  for (const XMLElement* each : source.section("asset")) {
    if (std::string_view(each->Name()) != "mesh") continue;
    const MjcfElement mesh = source.element(*each);
    MjcfMesh made;
    made.file = mesh.text_or("file", "");
    const std::string name = mesh.text_or("name", without_extension(made.file));
    source.owner = "mesh " + name;
    made.scale = source.vector(mesh, "scale", Vector3d::Ones());
    // Vertices are given about this reference; MuJoCo takes it off.
    const auto q = source.numbers(mesh, "refquat", 4, 4);
    const Eigen::Quaterniond turn =
        q ? Eigen::Quaterniond((*q)[0], (*q)[1], (*q)[2], (*q)[3]) : Eigen::Quaterniond::Identity();
    const Vector3d reference = source.vector(mesh, "refpos", Vector3d::Zero());
    if (turn.norm() > 1e-9)
      made.X_MV = make_pose(made.scale.cwiseProduct(reference), turn.normalized()).inverse();
    if (const auto vertices = source.numbers(mesh, "vertex", 12, vertices_at_most); vertices)
      for (std::size_t i = 0; i + 2 < vertices->size(); i += 3)
        made.vertices.push_back(made.scale.cwiseProduct(Vector3d(vertices->data() + i)));
    if (made.file.empty() && made.vertices.empty())
      source.complain(Severity::warning, "no-geometry", *each, "has neither a file nor vertices",
                      "name its file");
    else
      meshes[name] = std::move(made);
  }
  return meshes;
}

std::optional<MjcfGeom> read_geom(MjcfSource& source, const MjcfElement& geom, const Pose& X_BF,
                                  const MjcfMeshes& meshes, const std::set<std::string>& pairs) {
  return GeomReader(source, geom, X_BF).read(meshes, pairs);
}

void add_geoms(const std::vector<MjcfGeom>& geoms, RobotLink& link) {
  const auto has = [&](auto&& such) { return std::any_of(geoms.begin(), geoms.end(), such); };
  const auto is_hidden = [](const MjcfGeom& g) { return g.group >= first_collision_group; };
  const bool by_group = !has([](const MjcfGeom& g) { return g.touches; }) && has(is_hidden) &&
                        !std::all_of(geoms.begin(), geoms.end(), is_hidden);
  for (const MjcfGeom& geom : geoms) {
    auto& solids = geom.touches || (by_group && is_hidden(geom)) ? link.collision : link.visual;
    solids.insert(solids.end(), geom.solids.begin(), geom.solids.end());
  }
}

std::optional<Inertial> given_mass(const std::vector<MjcfGeom>& geoms) {
  Inertial sum;
  Vector3d moment = Vector3d::Zero();
  bool unknown = false;
  for (const MjcfGeom& geom : geoms) {
    const double mass = geom.mass.value_or(0);
    sum.mass += mass;
    moment += mass * geom.inertial_B.X_LI.translation();
    unknown = unknown || (mass > 0 && geom.inertial_B.inertia_I.isZero());
  }
  if (!(sum.mass > 0)) return std::nullopt;
  sum.X_LI.translation() = moment / sum.mass;
  for (const MjcfGeom& geom : geoms) {
    if (unknown || !geom.mass) continue;
    const Pose& X = geom.inertial_B.X_LI;
    const Vector3d r = X.translation() - sum.X_LI.translation();
    sum.inertia_I +=
        X.linear() * geom.inertial_B.inertia_I * X.linear().transpose() +
        *geom.mass * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
  }
  return sum;
}

}  // namespace prehend::planner
