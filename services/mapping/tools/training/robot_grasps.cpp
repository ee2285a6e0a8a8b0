#include "services/mapping/tools/training/robot_grasps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "common/grasping/catalogue_bodies.hpp"
#include "common/grasping/table_closing.hpp"
#include "common/model/past_contact.hpp"
#include "common/proto/pose_numbers.hpp"
#include "common/proto/robot_grasps.pb.h"
#include "common/proto/sealed_file.hpp"
#include "common/proto/vectors.hpp"

namespace prehend::mapping {

namespace {

using Eigen::Vector3d;

constexpr std::string_view kind = "robot-grasps";
constexpr double aside = 0.012, nearer = 0.015;  // m, where else the hand is tried
constexpr double unsure = 0.008;    // m, beside its place where a grasp shall hold as well
constexpr double short_hold = 0.5;  // s: drops what it drops at once

Expected<RobotGrasp> read(const messages::RobotGrasp& from, const model::HandModel& hand) {
  RobotGrasp grasp;
  grasp.object = from.object();
  const auto type = grasp_type_from_string(from.type());
  const auto shape = model::shape_from_string(from.shape());
  if (!type || !shape || from.size_size() != 3) return fail("a grasp without type or shape");
  grasp.type = *type;
  grasp.shape = {*shape, proto::to_vector(from.size())};
  if (!is_valid(grasp.shape)) return fail("a grasp of what has no size");
  auto X_OG = proto::pose_from_numbers({from.grasp_frame().begin(), from.grasp_frame().end()});
  if (!X_OG) return tl::unexpected(X_OG.error());
  grasp.X_OG = *X_OG;
  grasp.preshape = proto::to_vector(from.preshape());
  grasp.dof = proto::to_vector(from.dof());
  grasp.closing = proto::to_vector(from.closing());
  const auto dofs = static_cast<Eigen::Index>(hand.dofs().size());
  if (grasp.preshape.size() != dofs || grasp.dof.size() != dofs || grasp.closing.size() != dofs)
    return fail("a grasp with another number of DoF");
  if (!grasp.preshape.allFinite() || !grasp.dof.allFinite()) return fail("a grasp is not finite");
  if (from.place_size() != 3) return fail("a grasp without a place");
  grasp.p_GR = Eigen::Vector3d::Map(from.place().data());
  if (!grasp.p_GR.allFinite()) return fail("a grasp is not finite");
  grasp.epsilon = from.epsilon();
  grasp.held = from.held();
  return grasp;
}

/// Held on the table. The hand stands `beside` its place, m, in the direction in which it closes.
bool survives(const model::HandModel& hand, const Eigen::VectorXd& open,
              const grasping::Body& object, const RobotGrasp& grasp, double beside,
              const grasping::HoldOptions& hold) {
  const Pose X_OG = grasp.X_OR() * Eigen::Translation3d(0, beside, 0);
  return grasping::held_on_table(hand, object, {X_OG, open, grasp.dof, grasp.closing}, hold);
}

/// Closes the hand from a preshape on the object where it stands; fills in what comes of it.
Expected<void> close(const model::HandModel& hand, const grasping::Body& object,
                     const Preshape& preshape, RobotGrasp& grasp) {
  auto closed =
      grasping::close_on_table(hand, object, {grasp.X_OR(), preshape.robot, preshape.resting});
  if (!closed) return tl::unexpected(closed.error());
  grasp.preshape = preshape.robot;
  grasp.dof = std::move(closed->dof);
  grasp.closing = std::move(closed->closing);
  grasp.epsilon = closed->epsilon;
  return {};
}

}  // namespace

std::vector<GraspType> types_from(const Pose& X_OG) {
  if (!grasping::is_from_above(X_OG)) return {GraspType::power_wrap};
  return {GraspType::circular_sphere, GraspType::precision};
}

Eigen::VectorXd past_contact(const model::HandModel& hand, const RobotGrasp& grasp,
                             const Eigen::VectorXd& open, double angle) {
  return model::past_contact(hand, open, grasp.dof, grasp.closing, angle);
}

std::vector<Vector3d> places_to_try() {
  return {{0, 0, 0}, {0, aside, 0}, {0, -aside, 0}, {0, 0, nearer}, {0, 0, -nearer}};
}

Trials Trials::quick() {
  Trials trials;
  trials.hold = 1;
  trials.shake = trials.beside = trials.each_type = false;
  return trials;
}

Expected<RobotGrasp> robot_grasp(const model::HandModel& hand, const Scheme& scheme,
                                 const grasping::Body& object, const Pose& X_OG, GraspType type,
                                 const Trials& trials) {
  Error last{"no preshape is for this grasp", object.name, ""};
  std::optional<RobotGrasp> best;
  int most = -1;
  const int enough = trials.beside ? 3 : 1;
  for (const Vector3d& place : trials.places) {
    std::vector<RobotGrasp> closed;
    for (const Preshape& preshape : scheme.preshapes) {
      if (std::find(preshape.types.begin(), preshape.types.end(), type) == preshape.types.end())
        continue;
      RobotGrasp made;
      made.object = object.name;
      made.type = type;
      made.shape = object.shape;
      made.X_OG = X_OG;
      made.p_GR = place;
      if (auto ok = close(hand, object, preshape, made); ok)
        closed.push_back(std::move(made));
      else
        last = ok.error();
    }
    std::stable_sort(closed.begin(), closed.end(), [](const RobotGrasp& a, const RobotGrasp& b) {
      return a.epsilon > b.epsilon;
    });
    for (RobotGrasp& candidate : closed) {
      const auto survives_at = [&](double beside, double hold) {
        return survives(hand, scheme.open.robot, object, candidate, beside,
                        {.hold = hold, .shake = trials.shake});
      };
      candidate.held = survives_at(0, trials.hold);
      int survived = candidate.held ? 1 : 0;
      if (candidate.held && trials.beside)
        for (const double beside : {unsure, -unsure}) survived += survives_at(beside, short_hold);
      if (survived <= most) continue;
      most = survived;
      best = std::move(candidate);
      if (most == enough) return *best;
    }
  }
  if (!best) return tl::unexpected(last);
  return *best;
}

std::vector<RobotGrasp> close_on_catalogue(const model::HandModel& hand, const Scheme& scheme,
                                           const grasping::CatalogueBodies& catalogue,
                                           const grasping::ForEach& for_each,
                                           const std::function<void(const Error&)>& report,
                                           const Trials& trials) {
  struct Task {
    const grasping::Body* object;
    Pose X_OG;
    GraspType type;
    std::optional<Expected<RobotGrasp>> grasp;
  };
  // What is approached in the same way; its types go one after the other.
  std::vector<std::vector<Task>> approached;
  for (const grasping::Body& object : catalogue.bodies()) {
    const auto ways = grasping::approaches(object.shape, hand.reach());
    if (ways.empty()) report({"does not fit into the hand", object.name, "left out"});
    for (const Pose& X_OG : ways) {
      auto& tasks = approached.emplace_back();
      for (const GraspType type : types_from(X_OG)) tasks.push_back({&object, X_OG, type, {}});
    }
  }
  for_each(approached.size(), [&](std::size_t i) {
    // Until its fingers close, a hand cannot know the type: all of them from one place.
    Trials from = trials;
    for (Task& task : approached[i]) {
      task.grasp = robot_grasp(hand, scheme, *task.object, task.X_OG, task.type, from);
      if (*task.grasp && ((*task.grasp)->held || !from.each_type))
        from.places = {(*task.grasp)->p_GR};
    }
  });
  std::vector<RobotGrasp> grasps;
  for (auto& tasks : approached)
    for (Task& task : tasks) {
      if (*task.grasp)
        grasps.push_back(std::move(**task.grasp));
      else
        report({task.grasp->error().what,
                fmt::format("{}, {}", task.object->name, to_string(task.type)),
                "this grasp is left out"});
    }
  return grasps;
}

std::string encode_robot_grasps(const model::HandModel& hand, const std::vector<RobotGrasp>& grasps,
                                const std::string& made_for) {
  messages::RobotGrasps message;
  message.set_hand(hand.name());
  message.set_made_for(made_for);
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
    to.mutable_place()->Add(grasp.p_GR.begin(), grasp.p_GR.end());
    to.set_held(grasp.held);
  }
  return message.SerializeAsString();
}

Expected<std::vector<RobotGrasp>> decode_robot_grasps(const std::string& bytes,
                                                      const model::HandModel& hand,
                                                      const std::string& made_for) {
  messages::RobotGrasps message;
  if (!message.ParseFromString(bytes)) return fail("holds no grasps");
  bool same = message.dof_names_size() == static_cast<int>(hand.dofs().size());
  for (int i = 0; same && i < message.dof_names_size(); ++i)
    same = message.dof_names(i) == hand.dofs()[static_cast<std::size_t>(i)].name;
  if (message.hand() != hand.name() || !same)
    return fail(fmt::format("holds grasps of the hand «{}», not of this «{}»", message.hand(),
                            hand.name()));
  if (!made_for.empty() && !message.made_for().empty() && message.made_for() != made_for)
    return fail(fmt::format("holds grasps of the hand «{}» as it was before", hand.name()));
  std::vector<RobotGrasp> grasps;
  for (const messages::RobotGrasp& from : message.grasps()) {
    auto grasp = read(from, hand);
    if (!grasp) return tl::unexpected(grasp.error());
    grasps.push_back(std::move(*grasp));
  }
  return grasps;
}

Expected<void> save_robot_grasps(const std::filesystem::path& file, const model::HandModel& hand,
                                 const std::vector<RobotGrasp>& grasps,
                                 const std::string& made_for) {
  return proto::write_sealed(file, kind, encode_robot_grasps(hand, grasps, made_for));
}

Expected<std::vector<RobotGrasp>> load_robot_grasps(const std::filesystem::path& file,
                                                    const model::HandModel& hand,
                                                    const std::string& made_for) {
  auto grasps = proto::read_sealed(file, kind).and_then([&](const std::string& bytes) {
    return decode_robot_grasps(bytes, hand, made_for);
  });
  if (!grasps)
    return fail(grasps.error().what, file.string(),
                "make them again: prehend train --close --hand " + hand.name());
  return grasps;
}

}  // namespace prehend::mapping
