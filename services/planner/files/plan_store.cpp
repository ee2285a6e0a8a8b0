#include "services/planner/files/plan_store.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "common/base/file_text.hpp"
#include "common/base/log.hpp"
#include "common/model/past_contact.hpp"
#include "common/proto/grasp_candidates.pb.h"
#include "common/proto/pose_numbers.hpp"
#include "common/proto/sealed_file.hpp"
#include "common/proto/vectors.hpp"

namespace prehend::planner {
namespace {

namespace fs = std::filesystem;
using grasping::SureGrasp;

constexpr std::string_view kind = "grasp-candidates";
/// Changes when the same hand and object come to other grasps.
constexpr std::string_view searcher = "3";

template <class Numbers, class Repeated>
void put(const Numbers& numbers, Repeated& to) {
  to.Add(numbers.begin(), numbers.end());
}

std::string digest_of(const fs::path& hand_folder, const grasping::Body& object) {
  std::string all = fmt::format("{} {} {} {} {}\n", searcher, to_string(object.shape.kind),
                                fmt::format("{:.4f} {:.4f} {:.4f}", object.shape.size.x(),
                                            object.shape.size.y(), object.shape.size.z()),
                                object.mass, object.material);
  if (object.mesh)
    for (const auto& part : object.mesh->parts.parts)
      for (const Eigen::Vector3d& corner : part)
        all += fmt::format("{:.5f} {:.5f} {:.5f}\n", corner.x(), corner.y(), corner.z());
  const fs::path files = model::hand_files(hand_folder);
  for (const char* part : {"hand.urdf", "hand.toml"})
    all += proto::digest(read_file(files / part).value_or(""));
  return proto::digest(all);
}

Expected<SureGrasp> read(const messages::GraspCandidate& from, const model::HandModel& hand) {
  const auto dofs = static_cast<Eigen::Index>(hand.dofs().size());
  SureGrasp made;
  auto X_OG = proto::pose_from_numbers({from.approach().begin(), from.approach().end()});
  auto place = proto::pose_from_numbers({from.place().begin(), from.place().end()});
  if (!X_OG || !place) return fail("a grasp without a place");
  made.X_OG = *X_OG;
  made.grasp = {*place, proto::to_vector(from.preshape()), proto::to_vector(from.dof()),
                proto::to_vector(from.closing()), from.epsilon()};
  made.room = from.room();
  made.tried = from.attempt();
  made.follow_through = from.follow_through();
  for (const Eigen::VectorXd* values : {&made.grasp.open, &made.grasp.dof, &made.grasp.closing})
    if (values->size() != dofs || !values->allFinite())
      return fail("a grasp with another number of DoF");
  for (const Eigen::VectorXd* posture : {&made.grasp.open, &made.grasp.dof})
    if (!hand.clamp(*posture).isApprox(*posture, 1e-9))
      return fail("a posture beyond the hand's limits");
  if (made.grasp.closing.cwiseAbs().maxCoeff() > 1) return fail("a direction that is none");
  // Written so that not-a-number fails.
  if (!(made.room >= 0 && made.room <= 1)) return fail("a room that is no share");
  if (!(made.follow_through >= 0 && made.follow_through <= model::full_follow_through))
    return fail("a follow-through that no hand makes");
  return made;
}

}  // namespace

std::string encode(const Plan& plan, const std::string& made_for) {
  messages::GraspCandidates message;
  message.set_made_for(made_for);
  message.set_reason(plan.reason);
  for (const SureGrasp& grasp : plan.grasps) {
    messages::GraspCandidate& to = *message.add_candidates();
    put(proto::pose_numbers(grasp.X_OG), *to.mutable_approach());
    put(proto::pose_numbers(grasp.grasp.X_OG), *to.mutable_place());
    put(grasp.grasp.open, *to.mutable_preshape());
    put(grasp.grasp.dof, *to.mutable_dof());
    for (const double closing : grasp.grasp.closing) to.add_closing(static_cast<int>(closing));
    to.set_epsilon(grasp.grasp.epsilon);
    to.set_room(grasp.room);
    to.set_attempt(grasp.tried);
    to.set_follow_through(grasp.follow_through);
  }
  return message.SerializeAsString();
}

Expected<Plan> decode(const std::string& bytes, const model::HandModel& hand,
                      const grasping::Body& object, const std::string& made_for) {
  messages::GraspCandidates message;
  if (!message.ParseFromString(bytes)) return fail("holds no grasps");
  if (message.made_for() != made_for) return fail("was made for another hand or object");
  Plan plan{object, {}, true, message.reason()};
  for (const messages::GraspCandidate& from : message.candidates()) {
    auto grasp = read(from, hand);
    if (!grasp) return tl::unexpected(grasp.error());
    plan.grasps.push_back(std::move(*grasp));
  }
  return plan;
}

PlanStore plan_store(const fs::path& folder, const fs::path& hand_folder,
                     const model::HandModel& hand) {
  if (folder.empty()) return {};
  const auto file_of = [folder](const std::string& made_for) {
    return folder / (made_for.substr(0, 16) + ".candidates");
  };
  const auto warned = std::make_shared<bool>(false);
  return {[=, &hand](const grasping::Body& object) -> std::optional<Plan> {
            const std::string made_for = digest_of(hand_folder, object);
            const auto bytes = proto::read_sealed(file_of(made_for), kind);
            if (!bytes) return std::nullopt;
            auto plan = decode(*bytes, hand, object, made_for);
            return plan ? std::optional(std::move(*plan)) : std::nullopt;
          },
          [=](const Plan& plan) {
            std::error_code failed;
            fs::create_directories(folder, failed);
            const std::string made_for = digest_of(hand_folder, plan.object);
            const auto kept = proto::write_sealed(file_of(made_for), kind, encode(plan, made_for));
            if (!kept && !*warned) log::warning("plans are not kept: {}", kept.error().message());
            *warned = *warned || !kept;
          }};
}

}  // namespace prehend::planner
