#include "common/planning/room.hpp"

#include <btBulletCollisionCommon.h>
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "common/arm/collision.hpp"
#include "common/grasping/bullet.hpp"
#include "common/grasping/closest.hpp"
#include "common/grasping/surface.hpp"

namespace prehend::planning {
namespace {

using arm::Joints;
using Eigen::Vector3d;
using grasping::to_bullet;

constexpr double lever_of_turns = 0.15;  // m
constexpr double rounding = 0.0005;      // m, of distances that are tolerated
constexpr double min_step = 0.002;       // m, between two looks
constexpr int wrist = 2;  // the last links, which carry the hand and may come near its fingers
constexpr std::string_view table_name = "the table";

/// Something that moves with a link of the arm, with the hand, or not at all.
struct Part {
  enum Kind { link, hand, held, obstacle } kind = link;
  int index = 0;  // of the link of arm or hand, or of the obstacle
  std::string name;
  Pose X_PO = Pose::Identity();  // in the frame of what moves it; of an obstacle X_WO
  std::unique_ptr<btCollisionShape> shape;
  std::unique_ptr<btCollisionObject> object;
  btVector3 low, high;  // of the box along W's axes around it, where it is
};

/// A capsule along z of its own frame.
std::pair<std::unique_ptr<btCollisionShape>, Pose> make_capsule(const model::Capsule& capsule) {
  const Vector3d way = capsule.b - capsule.a;
  Pose X = make_pose(0.5 * (capsule.a + capsule.b));
  if (way.norm() > 1e-9)
    X.linear() = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), way).toRotationMatrix();
  return {std::make_unique<btCapsuleShapeZ>(capsule.radius, way.norm()), X};
}

Eigen::VectorXd fingers_of(const model::HandModel& hand, const Scene& scene) {
  return scene.dof.size() > 0 ? scene.dof : hand.postures().at("open");
}

double radius_of(const Solid& solid) {
  double radius = solid.parts.empty() ? model::half_extents(solid.shape).norm() : 0;
  for (const auto& part : solid.parts)
    for (const Vector3d& corner : part) radius = std::max(radius, corner.norm());
  return radius;
}

/// All that the last link carries: shapes of the hand, and a ball around what it holds.
std::vector<model::Capsule> all_carried(const Robot& robot, const Scene& scene, bool base_only) {
  const model::HandModel& hand = *robot.hand;
  const Pose X_LB = robot.arm->X_LE * robot.X_EB;
  const auto X_BL = hand.link_poses(hand.joint_angles(fingers_of(hand, scene)));
  std::vector<model::Capsule> made;
  for (std::size_t i = 0; i < (base_only ? 1 : X_BL.size()); ++i)
    for (const model::CollisionShape& shape : hand.links()[i].collision) {
      const model::Capsule part = model::capsule_around(shape);
      const Pose X = X_LB * X_BL[i];
      made.push_back({X * part.a, X * part.b, part.radius});
    }
  if (scene.held && !base_only) {
    const Vector3d p = (X_LB * scene.held->X_BO).translation();
    made.push_back({p, p, radius_of(scene.held->solid)});
  }
  return made;
}

/// Two things meet at a time: pools for thousands would cost more than all looks.
btDefaultCollisionConstructionInfo small_pools() {
  btDefaultCollisionConstructionInfo made;
  made.m_defaultMaxPersistentManifoldPoolSize = 16;
  made.m_defaultMaxCollisionAlgorithmPoolSize = 16;
  return made;
}

arm::Surroundings surroundings_of(const Robot& robot, const Scene& scene) {
  arm::Surroundings made;
  if (scene.table && robot.X_WA.linear().col(2).z() > 0.9999)
    made.table = -robot.X_WA.translation().z();
  made.carried = all_carried(robot, scene, true);
  made.may_touch = true;
  return made;
}

}  // namespace

std::string Conflict::message() const {
  return distance > 0 ? fmt::format("{} is {:.0f} mm from {}", first, 1000 * distance, second)
                      : fmt::format("{} touches {}", first, second);
}

struct Room::State {
  Robot robot;
  RoomOptions options;
  bool table;
  std::vector<Pose> X_BL;  // of the hand's links
  arm::Collision collision;
  Joints lever;
  double arm_clearance;  // of the arm from itself and the table
  std::vector<Part> parts;
  struct Pair {
    std::size_t first, second;
    double clearance;
  };
  std::vector<Pair> pairs;
  std::vector<std::pair<std::size_t, double>> above_table;  // parts, and their clearance
  btDefaultCollisionConfiguration configuration{small_pools()};
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btCollisionWorld world{&dispatcher, &broadphase, &configuration};

  State(const Robot& of, const Scene& scene, const RoomOptions& how)
      : robot(of),
        options(how),
        table(scene.table),
        X_BL(of.hand->link_poses(of.hand->joint_angles(fingers_of(*of.hand, scene)))),
        collision(*of.arm, surroundings_of(of, scene)),
        lever(arm::levers(*of.arm, all_carried(of, scene, false))),
        arm_clearance(how.clearance) {
    build(scene);
    pair();
    place_all(robot.arm->home, true);
  }

  void add(Part::Kind kind, int index, std::string name, const Pose& X_PO,
           std::unique_ptr<btCollisionShape> shape) {
    Part part{kind, index, std::move(name), X_PO, std::move(shape), {}, {}, {}};
    part.object = std::make_unique<btCollisionObject>();
    part.object->setCollisionShape(part.shape.get());
    parts.push_back(std::move(part));
  }

  void add(Part::Kind kind, int index, const Solid& solid, const Pose& X) {
    if (solid.parts.empty()) add(kind, index, solid.name, X, grasping::make_shape(solid.shape));
    for (const auto& corners : solid.parts)
      add(kind, index, solid.name, X, grasping::make_shape(corners));
  }

  void build(const Scene& scene) {
    for (std::size_t i = 0; i < robot.arm->links.size(); ++i)
      for (const model::Capsule& capsule : robot.arm->links[i].capsules) {
        auto [shape, X] = make_capsule(capsule);
        add(Part::link, static_cast<int>(i), robot.arm->links[i].name, X, std::move(shape));
      }
    for (std::size_t i = 0; i < robot.hand->links().size(); ++i)
      for (const model::CollisionShape& shape : robot.hand->links()[i].collision)
        add(Part::hand, static_cast<int>(i), "the hand", shape.X_LS,
            grasping::make_shape(shape.shape));
    if (scene.held) add(Part::held, 0, scene.held->solid, scene.held->X_BO);
    for (std::size_t i = 0; i < scene.obstacles.size(); ++i)
      add(Part::obstacle, static_cast<int>(i), scene.obstacles[i].solid, scene.obstacles[i].X_WO);
  }

  bool is_carried(std::size_t i) const {
    return parts[i].kind == Part::hand || parts[i].kind == Part::held;
  }

  /// Of parts in their order: links of the arm, the hand, what it holds, obstacles.
  bool is_pair(const Part& a, const Part& b) const {
    if (b.kind == Part::obstacle) {
      if (a.kind == Part::obstacle) return false;
      if (a.kind == Part::link) return a.index > 0;  // the base stands where it stands
      return b.name != options.touched;
    }
    if (a.kind != Part::link || b.kind == Part::link) return false;
    const int last = static_cast<int>(robot.arm->joints.size());
    return a.index <= last - wrist - (b.kind == Part::held ? 0 : 1);
  }

  void pair() {
    for (std::size_t a = 0; a < parts.size(); ++a)
      for (std::size_t b = a + 1; b < parts.size(); ++b)
        if (is_pair(parts[a], parts[b]))
          pairs.push_back(
              {a, b, is_carried(a) || is_carried(b) ? options.hand_clearance : options.clearance});
    for (std::size_t a = 0; a < parts.size(); ++a)
      if (is_carried(a) && table) above_table.emplace_back(a, options.hand_clearance);
  }

  void place_all(const Joints& q, bool also_fixed) {
    place_all(arm::forward(*robot.arm, q), also_fixed);
  }

  void place_all(const arm::Configuration& at, bool also_fixed) {
    const Pose X_WB = robot.X_WA * at.X_AE * robot.X_EB;
    for (Part& part : parts) {
      Pose X = part.X_PO;
      if (part.kind == Part::link)
        X = robot.X_WA * at.X_AL[static_cast<std::size_t>(part.index)] * part.X_PO;
      else if (part.kind == Part::hand)
        X = X_WB * X_BL[static_cast<std::size_t>(part.index)] * part.X_PO;
      else if (part.kind == Part::held)
        X = X_WB * part.X_PO;
      else if (!also_fixed)
        continue;
      part.object->setWorldTransform(to_bullet(X));
      part.shape->getAabb(part.object->getWorldTransform(), part.low, part.high);
    }
  }

  static bool apart(const Part& a, const Part& b, double by) {
    for (int i = 0; i < 3; ++i)
      if (a.low[i] - b.high[i] > by || b.low[i] - a.high[i] > by) return true;
    return false;
  }

  /// Distance, at most `most`.
  double distance(const Part& a, const Part& b, double most) {
    if (apart(a, b, most)) return most;
    grasping::ClosestDistance closest(most);
    world.contactPairTest(a.object.get(), b.object.get(), closest);
    return closest.distance;
  }

  static double height(const Part& part) {
    const btTransform& X = part.object->getWorldTransform();
    const auto* convex = static_cast<const btConvexShape*>(part.shape.get());
    const btVector3 down = X.getBasis().transpose() * btVector3(0, 0, -1);
    return (X * convex->localGetSupportingVertex(down)).z();
  }

  /// Calls with every pair's names and distance that is less than its clearance, until it says so.
  template <class Visit>
  void look(const Joints& q, const Visit& visit) {
    const arm::Configuration at = arm::forward(*robot.arm, q);
    const double own = collision.clearance(at, arm_clearance);
    if (own < arm_clearance && !visit("the arm", "itself or the table", own, arm_clearance)) return;
    place_all(at, false);
    for (auto& [index, clearance] : above_table) {
      if (parts[index].low.z() >= clearance) continue;
      const double z = height(parts[index]);
      if (z < clearance && !visit(parts[index].name, table_name, z, clearance)) return;
    }
    for (Pair& each : pairs) {
      const Part &a = parts[each.first], &b = parts[each.second];
      const double found = distance(a, b, each.clearance);
      if (found < each.clearance && !visit(a.name, b.name, found, each.clearance)) return;
    }
  }
};

Room::Room(const Robot& robot, const Scene& scene, const RoomOptions& options)
    : state_(std::make_unique<State>(robot, scene, options)) {}
Room::~Room() = default;
Room::Room(Room&&) noexcept = default;
Room& Room::operator=(Room&&) noexcept = default;

void Room::tolerate(const Joints& start) {
  state_->look(start, [](std::string_view, std::string_view, double found, double& clearance) {
    clearance = std::max(0.0, found - rounding);
    return true;
  });
  state_->options.min_dexterity = std::min(state_->options.min_dexterity, 0.9 * dexterity(start));
  while (state_->options.joint_margin > 0 && joint_at_limit(start))
    state_->options.joint_margin = std::max(0.0, state_->options.joint_margin - 0.01);
}

std::optional<Conflict> Room::conflict(const Joints& q) const {
  std::optional<Conflict> made;
  state_->look(q, [&](std::string_view first, std::string_view second, double found, double) {
    made = Conflict{std::string(first), std::string(second), found};
    return false;
  });
  return made;
}

double Room::dexterity(const Joints& q) const {
  const model::ArmModel& arm = *state_->robot.arm;
  arm::Jacobian J = arm::jacobian(arm, arm::forward(arm, q));
  J.bottomRows<3>() *= lever_of_turns;
  const Eigen::Matrix<double, 6, 6> squares = J * J.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> parts(squares,
                                                                         Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, parts.eigenvalues()[0]));
}

std::optional<std::size_t> Room::joint_at_limit(const Joints& q) const {
  const auto& joints = state_->robot.arm->joints;
  const double margin = state_->options.joint_margin;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const double value = q[static_cast<Eigen::Index>(i)];
    if (value < joints[i].lower + margin || value > joints[i].upper - margin) return i;
  }
  return std::nullopt;
}

bool Room::is_free(const Joints& q) const {
  return !joint_at_limit(q) && dexterity(q) >= state_->options.min_dexterity && !conflict(q);
}

/// Halves first: a way that is not free mostly shows that in its middle.
bool Room::is_free(const Joints& from, const Joints& to) const {
  if (!is_free(to)) return false;
  const double step =
      std::max(std::min(state_->options.clearance, state_->options.hand_clearance), min_step);
  const int parts = std::max(1, static_cast<int>(std::ceil(swept(from, to) / step)));
  int stride = 1;
  while (stride < parts) stride *= 2;
  for (; stride > 1; stride /= 2)
    for (int k = stride / 2; k < parts; k += stride)
      if (!is_free(Joints(from + static_cast<double>(k) / parts * (to - from)))) return false;
  return true;
}

std::string Room::trouble(const Joints& q) const {
  if (const auto joint = joint_at_limit(q))
    return state_->robot.arm->joints[*joint].name + " is at its limit";
  if (const auto found = conflict(q)) return found->message();
  return dexterity(q) < state_->options.min_dexterity ? "the arm is stretched or folded" : "";
}

double Room::swept(const Joints& from, const Joints& to) const {
  return (to - from).cwiseAbs().dot(state_->lever);
}

}  // namespace prehend::planning
