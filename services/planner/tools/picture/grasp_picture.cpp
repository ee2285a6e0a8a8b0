#include "services/planner/tools/picture/grasp_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/analysis/materials.hpp"
#include "common/model/placement.hpp"

namespace prehend::planner {
namespace {

using Eigen::Vector3d;

constexpr double cone_length = 0.016;  // m
constexpr double touch_radius = 0.0032;
constexpr double field = 0.42;   // width of the picture at unit distance
constexpr double filled = 0.86;  // share of it that hand and object take

/// In the order of analysis::Material.
const std::array<Paint, 6> hand_paint{{{{0.62, 0.78, 0.80}, 0.5},     // glass
                                       {{0.66, 0.69, 0.74}, 0.55},    // metal
                                       {{0.93, 0.93, 0.91}, 0.25},    // plastic
                                       {{0.72, 0.53, 0.33}, 0.08},    // wood
                                       {{0.33, 0.37, 0.44}, 0.12},    // rubber
                                       {{0.58, 0.56, 0.53}, 0.05}}};  // stone
constexpr double object_opacity = 0.5;
const std::array<Vector3d, 6> object_colour{{{0.45, 0.80, 0.85},
                                             {0.60, 0.66, 0.75},
                                             {0.05, 0.50, 0.74},
                                             {0.87, 0.64, 0.34},
                                             {0.30, 0.42, 0.40},
                                             {0.62, 0.58, 0.54}}};
const Paint cone_paint{{0.99, 0.62, 0.08}, 0.1, 1, 0.55},
    touch_paint{{0.88, 0.08, 0.12}, 0.2, 1, 0.4};

std::size_t index_of(const std::string& material) {
  return static_cast<std::size_t>(
      analysis::material_from_string(material).value_or(analysis::Material::wood));
}

void append(std::vector<Triangle>& to, std::vector<Triangle> more) {
  to.insert(to.end(), more.begin(), more.end());
}

/// Adds its links; returns the paints that it uses.
std::vector<int> add_hand(Drawing& drawing, const model::HandModel& hand, const Pose& X_WB,
                          const Eigen::VectorXd& joints) {
  std::vector<int> paints;
  const std::vector<Pose> X_BL = hand.link_poses(joints);
  for (std::size_t i = 0; i < hand.links().size(); ++i) {
    const int paint = static_cast<int>(index_of(hand.links()[i].material));
    if (std::find(paints.begin(), paints.end(), paint) == paints.end()) paints.push_back(paint);
    for (const model::CollisionShape& part : hand.links()[i].collision)
      append(drawing.triangles, surface_of(part.shape, X_WB * X_BL[i] * part.X_LS, paint));
  }
  return paints;
}

double lowest(const Drawing& drawing) {
  double z = 0;
  for (const Triangle& triangle : drawing.triangles)
    for (const Vector3d& p : triangle.p) z = std::min(z, p.z());
  return z;
}

}  // namespace

Viewpoint look_at(const Drawing& drawing, const Vector3d& from, double aspect) {
  Viewpoint view;
  view.width = field;
  Eigen::Matrix3d R;
  R.col(2) = -from;
  R.col(0) = R.col(2).cross(Vector3d::UnitZ()).normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  Vector3d target = Vector3d::Zero();
  double distance = 3;
  for (int round = 0; round < 4; ++round) {
    view.X_WV = make_pose(target + distance * from, R);
    const Pose X_VW = view.X_WV.inverse();
    Eigen::Vector2d low(1e9, 1e9), high(-1e9, -1e9);
    for (const Triangle& triangle : drawing.triangles)
      for (const Vector3d& p_W : triangle.p) {
        const Vector3d p = X_VW * p_W;
        const Eigen::Vector2d seen = p.head<2>() / std::max(p.z(), 0.05);
        low = low.cwiseMin(seen);
        high = high.cwiseMax(seen);
      }
    const Eigen::Vector2d middle = 0.5 * distance * (low + high), size = high - low;
    target += R.leftCols<2>() * middle;
    distance *= std::max(size.x(), size.y() * aspect) / (filled * field);
  }
  view.X_WV = make_pose(target + distance * from, R);
  return view;
}

Expected<GraspDrawing> draw_grasp(const model::HandModel& hand, const grasping::Body& object,
                                  const grasping::PlannedGrasp& grasp) {
  if (grasp.joints.size() != static_cast<Eigen::Index>(hand.joints().size()))
    return fail("the grasp has another number of joints than the hand", hand.name(),
                "was the hand changed since the plan was made?");
  if (!model::is_valid(object.shape)) return fail("has no valid shape", object.name);
  GraspDrawing made;
  Drawing& drawing = made.drawing;
  drawing.paints.assign(hand_paint.begin(), hand_paint.end());
  const auto add_paint = [&](const Paint& paint) {
    drawing.paints.push_back(paint);
    return static_cast<int>(drawing.paints.size()) - 1;
  };
  made.object_paint = add_paint({object_colour[index_of(object.material)], 0.35, object_opacity});
  made.cone_paint = add_paint(cone_paint);
  made.touch_paint = add_paint(touch_paint);

  made.hand_paints = add_hand(drawing, hand, grasp.X_OB, grasp.joints);
  append(drawing.triangles, surface_of(object.shape, Pose::Identity(), made.object_paint));
  for (const analysis::Contact& contact : grasp.contacts) {
    const double angle = std::max(0.05, std::atan(contact.friction));
    append(drawing.triangles, cone(contact.p_OC, contact.normal_O, std::min(angle, 1.2),
                                   cone_length * std::cos(std::min(angle, 1.2)), made.cone_paint));
    const model::Shape ball{model::ShapeKind::sphere, Vector3d::Constant(touch_radius)};
    append(drawing.triangles, surface_of(ball, make_pose(contact.p_OC), made.touch_paint));
  }
  drawing.floor = std::min(lowest(drawing), -model::half_extents(object.shape).z());
  return made;
}

Drawing draw_hand(const model::HandModel& hand, const Eigen::VectorXd& dof) {
  Drawing drawing;
  drawing.paints.assign(hand_paint.begin(), hand_paint.end());
  const Pose X_WG =
      make_pose(Vector3d::Zero(), model::grasp_axes(Vector3d::UnitX(), Vector3d::UnitY()));
  add_hand(drawing, hand, X_WG * hand.X_BG().inverse(), hand.joint_angles(dof));
  drawing.floor = lowest(drawing);
  return drawing;
}

Viewpoint best_view(const GraspDrawing& scene, double aspect) {
  constexpr int width = 160;
  const int height = static_cast<int>(width / aspect);
  Viewpoint best;
  double most = -1;
  for (int i = 0; i < 24; ++i)
    for (const double elevation : {0.22, 0.45, 0.75}) {
      const double azimuth = 2 * std::numbers::pi * i / 24;
      const Vector3d direction(std::cos(elevation) * std::cos(azimuth),
                               std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      const Viewpoint view = look_at(scene.drawing, direction, aspect);
      const std::vector<int> seen = scene.drawing.coverage(view, width, height);
      const auto pixels = [&](int paint) { return seen[static_cast<std::size_t>(paint)]; };
      const double worth = pixels(scene.object_paint) + 4.0 * pixels(scene.cone_paint) +
                           8.0 * pixels(scene.touch_paint);
      if (worth > most) {
        most = worth;
        best = view;
      }
    }
  return best;
}

Expected<void> save(const std::filesystem::path& file, const Raster& raster) {
  const cv::Mat rgb(raster.height, raster.width, CV_8UC3,
                    const_cast<std::uint8_t*>(raster.rgb.data()));
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  try {
    if (cv::imwrite(file.string(), bgr)) return {};
  } catch (const cv::Exception&) {
  }
  return fail("cannot be written", file.string(),
              "a name that ends in .png or .jpg, in a folder that is writable");
}

}  // namespace prehend::planner
