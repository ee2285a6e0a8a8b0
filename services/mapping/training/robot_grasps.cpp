#include "robot_grasps.hpp"

#include <fmt/format.h>
#include <prehend/messages/robot_grasps.pb.h>

#include <algorithm>
#include <optional>
#include <prehend/grasping/closing.hpp>
#include <prehend/model/placement.hpp>
#include <prehend/proto/pose_numbers.hpp>
#include <prehend/proto/sealed_file.hpp>

namespace prehend::mapping {

namespace {

using Eigen::Vector3d;

constexpr std::string_view kind = "robot-grasps";

template <class Repeated>
Eigen::VectorXd to_vector(const Repeated& values) {
  Eigen::VectorXd vector(values.size());
  std::copy(values.begin(), values.end(), vector.begin());
  return vector;
}

Expected<RobotGrasp> read(const messages::RobotGrasp& from, const model::HandModel& hand) {
  RobotGrasp grasp;
  grasp.object = from.object();
  const auto type = grasp_type_from_string(from.type());
  const auto shape = model::shape_from_string(from.shape());
  if (!type || !shape || from.size_size() != 3) return fail("a grasp without type or shape");
  grasp.type = *type;
  grasp.shape = {*shape, to_vector(from.size())};
  if (!is_valid(grasp.shape)) return fail("a grasp of what has no size");
  auto X_OG = proto::pose_from_numbers({from.grasp_frame().begin(), from.grasp_frame().end()});
  if (!X_OG) return tl::unexpected(X_OG.error());
  grasp.X_OG = *X_OG;
  grasp.preshape = to_vector(from.preshape());
  grasp.dof = to_vector(from.dof());
  grasp.closing = to_vector(from.closing());
  const auto dofs = static_cast<Eigen::Index>(hand.dofs().size());
  if (grasp.preshape.size() != dofs || grasp.dof.size() != dofs || grasp.closing.size() != dofs)
    return fail("a grasp with another number of DoF");
  if (!grasp.preshape.allFinite() || !grasp.dof.allFinite()) return fail("a grasp is not finite");
  grasp.epsilon = from.epsilon();
  grasp.held = from.held();
  return grasp;
}

/// True if no part of the hand is below the table, z = bottom in O, anywhere between the two
/// postures. Parts count as boxes; the palm is where the reach of the hand allows it to be.
bool above_table(const model::HandModel& hand, const Pose& X_OB, const Eigen::VectorXd& from,
                 const Eigen::VectorXd& to, double bottom) {
  constexpr int steps = 8;
  for (int step = 0; step <= steps; ++step) {
    const Eigen::VectorXd dof = from + (to - from) * (static_cast<double>(step) / steps);
    const std::vector<Pose> X_BL = hand.link_poses(hand.joint_angles(dof));
    for (std::size_t link = 1; link < X_BL.size(); ++link)
      for (const model::CollisionShape& part : hand.links()[link].collision) {
        const Pose X_OS = X_OB * X_BL[link] * part.X_LS;
        const double below =
            X_OS.linear().row(2).cwiseAbs().dot(model::half_extents(part.shape).transpose());
        if (X_OS.translation().z() - below < bottom) return false;
      }
  }
  return true;
}

}  // namespace

std::vector<Pose> approaches(const model::Shape& shape, const model::Reach& reach) {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  std::vector<Pose> seeds{make_pose(Vector3d::Zero(), model::grasp_axes(-z, y)),
                          make_pose(Vector3d::Zero(), model::grasp_axes(x, y))};
  // Turning about the axis of what is round or square is nothing new.
  if (shape.kind == model::ShapeKind::box && shape.size.x() != shape.size.y()) {
    seeds.push_back(make_pose(Vector3d::Zero(), model::grasp_axes(-z, x)));
    seeds.push_back(make_pose(Vector3d::Zero(), model::grasp_axes(y, x)));
  }
  std::vector<Pose> found;
  for (const Pose& seed : seeds) {
    const auto grasp = model::nearest_grasp(shape, seed, reach);
    const auto same = [&](const Pose& other) {
      return angle_between(other.linear(), grasp->linear()) < 0.1;
    };
    // What came out far from what was asked answers another approach.
    if (grasp && angle_between(seed.linear(), grasp->linear()) < 0.1 &&
        std::none_of(found.begin(), found.end(), same))
      found.push_back(*grasp);
  }
  return found;
}

std::vector<GraspType> types_from(const Pose& X_OG) {
  if (X_OG.linear()(2, 2) > -0.7) return {GraspType::power_wrap};
  return {GraspType::circular_sphere, GraspType::precision};
}

Eigen::VectorXd past_contact(const model::HandModel& hand, const RobotGrasp& grasp, double angle) {
  Eigen::VectorXd dof = grasp.dof;
  for (Eigen::Index i = 0; i < dof.size(); ++i)
    dof[i] +=
        angle * grasp.closing[i] * grasping::radian_of(hand.dofs()[static_cast<std::size_t>(i)]);
  return hand.clamp(dof);
}

Expected<RobotGrasp> robot_grasp(const model::HandModel& hand, const Scheme& scheme,
                                 const model::CatalogueObject& object, const Pose& X_OG,
                                 GraspType type) {
  const Pose X_BO = hand.X_BG() * X_OG.inverse();
  const grasping::Body body{object.name, object.shape, object.mass, object.material, {}};
  grasping::ClosingOptions options;
  options.volume = false;
  options.down_B = X_BO.linear() * -Vector3d::UnitZ();

  const double table = -model::half_extents(object.shape).z();
  struct Closed {
    const Preshape* preshape;
    grasping::ClosedGrasp grasp;
  };
  std::vector<Closed> closed;
  Error last{"no preshape is for this grasp", object.name, ""};
  for (const Preshape& preshape : scheme.preshapes) {
    if (std::find(preshape.types.begin(), preshape.types.end(), type) == preshape.types.end())
      continue;
    options.resting = preshape.resting;
    auto grasp = grasping::close_hand(hand, body, X_BO, preshape.robot, options);
    if (!grasp)
      last = grasp.error();
    else if (!above_table(hand, X_BO.inverse(), preshape.robot, grasp->dof, table))
      last = {"fingers would reach into the table", object.name, ""};
    else
      closed.push_back({&preshape, std::move(*grasp)});
  }
  if (closed.empty()) return tl::unexpected(last);
  std::stable_sort(closed.begin(), closed.end(), [](const Closed& a, const Closed& b) {
    return a.grasp.quality.epsilon > b.grasp.quality.epsilon;
  });
  // Lifting and shaking cost most of the time: only until one holds, best first.
  options.hold_test = grasping::HoldOptions{.shake = true};
  const Closed* best = nullptr;
  for (const Closed& candidate : closed) {
    options.resting = candidate.preshape->resting;
    const auto lifted = grasping::close_hand(hand, body, X_BO, candidate.preshape->robot, options);
    if (!lifted || !lifted->hold || !lifted->hold->held) continue;
    best = &candidate;
    break;
  }
  const bool held = best != nullptr;
  if (!best) best = &closed.front();
  RobotGrasp made{object.name,
                  type,
                  object.shape,
                  X_OG,
                  best->preshape->robot,
                  best->grasp.dof,
                  Eigen::VectorXd(best->grasp.dof.size()),
                  best->grasp.quality.epsilon,
                  held};
  for (std::size_t i = 0; i < hand.dofs().size(); ++i)
    made.closing[static_cast<Eigen::Index>(i)] =
        best->preshape->resting[i] ? 0 : hand.dofs()[i].closing;
  return made;
}

std::vector<RobotGrasp> close_on_catalogue(const model::HandModel& hand, const Scheme& scheme,
                                           const model::Catalogue& catalogue,
                                           const grasping::ForEach& for_each,
                                           const std::function<void(const Error&)>& report) {
  struct Task {
    const model::CatalogueObject* object;
    Pose X_OG;
    GraspType type;
  };
  std::vector<Task> tasks;
  for (const model::CatalogueObject& object : catalogue.objects()) {
    const auto ways = approaches(object.shape, hand.reach());
    if (ways.empty()) report({"does not fit into the hand", object.name, "left out"});
    for (const Pose& X_OG : ways)
      for (const GraspType type : types_from(X_OG)) tasks.push_back({&object, X_OG, type});
  }
  std::vector<std::optional<Expected<RobotGrasp>>> closed(tasks.size());
  for_each(tasks.size(), [&](std::size_t i) {
    closed[i] = robot_grasp(hand, scheme, *tasks[i].object, tasks[i].X_OG, tasks[i].type);
  });
  std::vector<RobotGrasp> grasps;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (*closed[i])
      grasps.push_back(std::move(**closed[i]));
    else
      report({closed[i]->error().what,
              fmt::format("{}, {}", tasks[i].object->name, to_string(tasks[i].type)),
              "this grasp is left out"});
  }
  return grasps;
}

Expected<void> save_robot_grasps(const std::filesystem::path& file, const model::HandModel& hand,
                                 const std::vector<RobotGrasp>& grasps) {
  messages::RobotGrasps message;
  message.set_hand(hand.name());
  for (const model::HandDof& dof : hand.dofs()) message.add_dof_names(dof.name);
  for (const RobotGrasp& grasp : grasps) {
    messages::RobotGrasp& to = *message.add_grasps();
    to.set_object(grasp.object);
    to.set_type(std::string(to_string(grasp.type)));
    to.set_shape(std::string(model::to_string(grasp.shape.kind)));
    to.mutable_size()->Add(grasp.shape.size.begin(), grasp.shape.size.end());
    const auto X_OG = proto::pose_numbers(grasp.X_OG);
    to.mutable_grasp_frame()->Add(X_OG.begin(), X_OG.end());
    to.mutable_preshape()->Add(grasp.preshape.begin(), grasp.preshape.end());
    to.mutable_dof()->Add(grasp.dof.begin(), grasp.dof.end());
    for (const double closing : grasp.closing)
      to.add_closing(closing > 0 ? 1 : closing < 0 ? -1 : 0);
    to.set_epsilon(grasp.epsilon);
    to.set_held(grasp.held);
  }
  return proto::write_sealed(file, kind, message.SerializeAsString());
}

Expected<std::vector<RobotGrasp>> load_robot_grasps(const std::filesystem::path& file,
                                                    const model::HandModel& hand) {
  const std::string mend = "make them again: prehend train --hand " + hand.name();
  const auto bytes = proto::read_sealed(file, kind);
  if (!bytes) return fail(bytes.error().what, file.string(), mend);
  messages::RobotGrasps message;
  if (!message.ParseFromString(*bytes)) return fail("holds no grasps", file.string(), mend);
  bool same = message.dof_names_size() == static_cast<int>(hand.dofs().size());
  for (int i = 0; same && i < message.dof_names_size(); ++i)
    same = message.dof_names(i) == hand.dofs()[static_cast<std::size_t>(i)].name;
  if (message.hand() != hand.name() || !same)
    return fail(
        fmt::format("holds grasps of the hand «{}», not of this «{}»", message.hand(), hand.name()),
        file.string(), mend);
  std::vector<RobotGrasp> grasps;
  for (const messages::RobotGrasp& from : message.grasps()) {
    auto grasp = read(from, hand);
    if (!grasp) return fail(grasp.error().what, file.string(), mend);
    grasps.push_back(std::move(*grasp));
  }
  return grasps;
}

}  // namespace prehend::mapping
