#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/base/pose.hpp"
#include "common/model/catalogue.hpp"
#include "common/model/placement.hpp"

namespace prehend::model {

/// One object standing on the table. W: origin on the table's top, z up.
struct PlacedObject {
  std::string name;  // in the catalogue
  Pose X_WO;         // of its centre
};

struct Light {
  Eigen::Vector3d to_light_W = {0.3, -0.4, 0.87};  // unit
  double ambient = 0.45;                           // share of the light that comes from everywhere
  double gain = 1.0;                               // of the camera's exposure
  Eigen::Vector3d colour = {1, 1, 1};              // RGB
};

/// The synthetic person: who reaches for what, and how badly.
struct Demonstrator {
  std::string user = "demo";
  std::string target;       // object; empty: poses only
  double hand_scale = 1.0;  // 1 = average adult
  double grasp_yaw = 0;     // rad about z of W: from where a cylinder is approached
  /// m: both hands press the target and carry it so far; zero: one grasps it and puts it back.
  Eigen::Vector3d carry_W = {0, 0, 0};
  /// Then: the right hand's grasp frame in the target where they press, from +x of O; the left
  /// hand's is its mirror image at x = 0.
  Pose X_OG = Pose::Identity();
  /// Then they do not press: the left hand takes it, lifts it and holds it out half-way, the right
  /// one takes it over and sets it down. The left hand's X_OG is also mirrored at z = 0.
  bool hands_over = false;
  Reach reach;  // of the hand that is led: whoever leads it sees it and gives it room
  Eigen::Vector3d approach_offset = {0, 0, 0};  // m, error of the palm in the hand's frame
  Eigen::Vector3d approach_turn = {0, 0, 0};    // rad, rotation vector of the same
  double position_noise = 0.0015;               // m, sigma a coordinate of each sensor
  double angle_noise = 0.005;                   // rad, sigma of each sensor's rotation
  double extreme_rate = 0.01;                   // share of readings that are extreme points
  std::uint64_t seed = 1;                       // of the noise and of the sensors' mounting
};

/// What is true in the room: the synthetic camera renders it, the synthetic hand reaches into it
/// and the simulation builds its world from it.
struct Scene {
  std::string name = "scene";
  std::vector<PlacedObject> objects;
  Light light;
  Eigen::Vector3d table_colour = {0.55, 0.45, 0.35};  // sRGB
  std::uint64_t texture_seed = 1;                     // of the table's grain and the background
  Demonstrator demonstrator;
  /// For recordings of a bare hand, which have no place in the room.
  Pose X_WH = Pose::Identity();
  double recording_rate = 30;  // Hz, where a recording has no time stamps
};

Expected<Scene> load_scene(const std::filesystem::path& file, const Catalogue& catalogue);
/// TOML text that load_scene reads back exactly.
std::string to_toml(const Scene& scene);

struct SceneOptions {
  std::string target;                  // empty: drawn from `graspable`
  std::vector<std::string> graspable;  // names to draw the target from; empty: the whole catalogue
  int distractors = 2;                 // other objects, at least 0.3 m away from the target
};

/// A scene drawn from a seed: object, pose, light, user, approach and noise. Fails when the target
/// is not in the catalogue.
Expected<Scene> make_scene(const Catalogue& catalogue, std::uint64_t seed,
                           const SceneOptions& options);

}  // namespace prehend::model
