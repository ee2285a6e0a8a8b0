#include "common/model/arm_model.hpp"

#include <algorithm>
#include <set>

#include "common/base/paths.hpp"

namespace prehend::model {
namespace {

std::vector<std::filesystem::path> arm_folders() {
  std::vector<std::filesystem::path> folders{share_directory() / "models" / "arms"};
  if (const auto own = data_directory(); !own.empty()) folders.push_back(own / "models" / "arms");
  return folders;
}

}  // namespace

Capsule capsule_around(const CollisionShape& shape) {
  const Eigen::Vector3d half = half_extents(shape.shape);
  Eigen::Vector3d along = Eigen::Vector3d::Zero();
  Capsule capsule;
  switch (shape.shape.kind) {
    case ShapeKind::cylinder:
    case ShapeKind::cone:
      along.z() = half.z();
      capsule.radius = half.x();
      break;
    case ShapeKind::box: {
      Eigen::Index longest = 0;
      half.maxCoeff(&longest);
      along[longest] = half[longest];
      capsule.radius = (half - along).norm();
      break;
    }
    default:
      capsule.radius = half.x();
  }
  capsule.a = shape.X_LS * Eigen::Vector3d(-along);
  capsule.b = shape.X_LS * along;
  return capsule;
}

std::filesystem::path arm_directory(const std::string& arm) {
  if (arm.find('/') != std::string::npos) return arm;
  const auto folders = arm_folders();
  std::error_code none;
  for (const auto& folder : folders)
    if (std::filesystem::exists(folder / arm / "arm.toml", none)) return folder / arm;
  // What is no name may be a folder that lies here.
  if (std::filesystem::exists(std::filesystem::path(arm) / "arm.toml", none)) return arm;
  return folders.front() / arm;
}

std::vector<std::string> arm_names() {
  std::set<std::string> names;
  std::error_code none;
  for (const auto& folder : arm_folders())
    for (const auto& entry : std::filesystem::directory_iterator(folder, none))
      if (std::filesystem::exists(entry.path() / "arm.toml", none))
        names.insert(entry.path().filename().string());
  return {names.begin(), names.end()};
}

std::string arm_hint() {
  std::string names;
  for (const std::string& name : arm_names()) names += (names.empty() ? "" : ", ") + name;
  return "choose one of " + names + ", or give the path of a folder";
}

}  // namespace prehend::model
