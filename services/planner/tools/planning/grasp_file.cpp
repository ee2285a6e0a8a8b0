#include "services/planner/tools/planning/grasp_file.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "common/analysis/materials.hpp"
#include "common/proto/grasp.pb.h"
#include "common/proto/sealed_file.hpp"

namespace prehend::planner {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;
using grasping::Plan;
using grasping::PlannedGrasp;

constexpr const char* kind = "planned-grasps";
constexpr int max_grasps = 100'000, max_contacts = 1000, max_dofs = 1000;

using Numbers = google::protobuf::RepeatedField<double>;

template <class Values>
void put(Numbers& to, const Values& values) {
  to.Add(values.data(), values.data() + values.size());
}

/// The numbers, if there are so many of them (any number up to a limit if count < 0), all finite.
Expected<VectorXd> numbers(const Numbers& from, int count, const char* what) {
  if (count < 0 ? from.size() > max_dofs : from.size() != count)
    return fail("wrong number of values", what);
  VectorXd values = Eigen::Map<const VectorXd>(from.data(), from.size());
  if (!values.allFinite()) return fail("values are not finite", what);
  return values;
}

void put(messages::GraspPose& to, const Pose& X) {
  const Vector3d p = X.translation();
  const Eigen::Quaterniond q(X.linear());
  put(*to.mutable_position(), p);
  for (const double value : {q.w(), q.x(), q.y(), q.z()}) to.add_orientation(value);
}

Expected<Pose> pose(const messages::GraspPose& from, const char* what) {
  const auto p = numbers(from.position(), 3, what);
  if (!p) return tl::unexpected(p.error());
  const auto q = numbers(from.orientation(), 4, what);
  if (!q) return tl::unexpected(q.error());
  return checked_pose(Vector3d(*p), Eigen::Quaterniond((*q)[0], (*q)[1], (*q)[2], (*q)[3]));
}

void put(messages::GraspContact& to, const analysis::Contact& contact) {
  to.set_link(contact.link);
  put(*to.mutable_position(), contact.p_OC);
  put(*to.mutable_normal(), contact.normal_O);
  to.set_friction(contact.friction);
  to.set_force(contact.force);
  to.set_depth(contact.depth);
  to.set_torsion(contact.torsion);
  put(*to.mutable_tangent(), contact.tangent_O);
}

Expected<analysis::Contact> contact(const messages::GraspContact& from) {
  const auto p = numbers(from.position(), 3, "contact");
  if (!p) return tl::unexpected(p.error());
  const auto n = numbers(from.normal(), 3, "contact");
  if (!n) return tl::unexpected(n.error());
  if (std::abs(n->norm() - 1) > 1e-6) return fail("normal is not of unit length", "contact");
  const auto tangent = numbers(from.tangent(), 3, "contact");
  if (!tangent) return tl::unexpected(tangent.error());
  for (const double value : {from.friction(), from.force(), from.depth(), from.torsion()})
    if (!std::isfinite(value) || value < 0) return fail("values must be 0 or more", "contact");
  analysis::Contact made;
  made.link = from.link();
  made.p_OC = *p;
  made.normal_O = *n;
  made.friction = from.friction();
  made.force = from.force();
  made.depth = from.depth();
  made.torsion = from.torsion();
  made.tangent_O = *tangent;
  return made;
}

void put(messages::GraspHold& to, const grasping::HoldResult& hold) {
  to.set_held(hold.held);
  to.set_slip(hold.slip);
  to.set_turn(hold.turn);
  to.set_drift(hold.drift);
  to.set_reason(hold.reason);
  if (hold.lift) to.set_lift(*hold.lift);
  if (hold.shake) to.set_shake(*hold.shake);
  if (hold.turned_over) to.set_turned_over(*hold.turned_over);
}

Expected<grasping::HoldResult> hold(const messages::GraspHold& from) {
  for (const double value : {from.slip(), from.turn(), from.drift()})
    if (!std::isfinite(value) || value < 0) return fail("values must be 0 or more", "hold test");
  grasping::HoldResult made;
  made.held = from.held();
  made.slip = from.slip();
  made.turn = from.turn();
  made.drift = from.drift();
  made.reason = from.reason();
  if (from.has_lift()) made.lift = from.lift();
  if (from.has_shake()) made.shake = from.shake();
  if (from.has_turned_over()) made.turned_over = from.turned_over();
  return made;
}

void put(messages::SavedGrasp& to, const PlannedGrasp& grasp) {
  to.set_candidate(static_cast<std::uint32_t>(grasp.candidate));
  to.set_posture(grasp.posture);
  put(*to.mutable_preshape(), grasp.preshape);
  put(*to.mutable_x_ob_before(), grasp.X_OB_before);
  put(*to.mutable_x_ob(), grasp.X_OB);
  put(*to.mutable_dof(), grasp.dof);
  put(*to.mutable_joints(), grasp.joints);
  for (const analysis::Contact& touch : grasp.contacts) put(*to.add_contacts(), touch);
  put(*to.mutable_wrenches(), grasp.wrenches);
  to.set_epsilon(grasp.quality.epsilon);
  to.set_volume(grasp.quality.volume);
  put(*to.mutable_weakest_direction(), grasp.quality.weakest_direction);
  put(*to.mutable_hold(), grasp.hold);
}

/// Moves the value into its place, or says why there is none.
template <class Value, class Place>
Expected<void> take(Expected<Value> value, Place& place) {
  if (!value) return tl::unexpected(value.error());
  place = std::move(*value);
  return {};
}

Expected<PlannedGrasp> grasp(const messages::SavedGrasp& from) {
  PlannedGrasp made;
  made.candidate = static_cast<int>(from.candidate() & 0x7fffffffu);
  made.posture = from.posture();
  VectorXd wrenches, weakest;
  const int columns = from.wrenches_size() / 6;
  if (from.contacts_size() > max_contacts || columns > 100 * max_contacts)
    return fail("too many contacts", "grasp");
  for (const Expected<void>& taken :
       {take(numbers(from.preshape(), -1, "preshape"), made.preshape),
        take(numbers(from.dof(), from.preshape_size(), "dof"), made.dof),
        take(numbers(from.joints(), -1, "joints"), made.joints),
        take(pose(from.x_ob_before(), "pose"), made.X_OB_before),
        take(pose(from.x_ob(), "pose"), made.X_OB),
        take(numbers(from.wrenches(), 6 * columns, "wrenches"), wrenches),
        take(numbers(from.weakest_direction(), 6, "weakest direction"), weakest),
        take(hold(from.hold()), made.hold)})
    if (!taken) return tl::unexpected(taken.error());
  for (const messages::GraspContact& touch : from.contacts()) {
    auto read = contact(touch);
    if (!read) return tl::unexpected(read.error());
    made.contacts.push_back(std::move(*read));
  }
  made.wrenches = wrenches.reshaped(6, columns);
  if (!std::isfinite(from.epsilon()) || !std::isfinite(from.volume()) || from.volume() < 0)
    return fail("quality is not finite", "grasp");
  made.quality.epsilon = from.epsilon();
  made.quality.volume = from.volume();
  made.quality.force_closure = from.epsilon() > 0;
  made.quality.weakest_direction = weakest;
  return made;
}

}  // namespace

std::string serialise(const Plan& plan) {
  messages::SavedPlan message;
  message.set_hand(plan.hand);
  message.set_object(plan.object.name);
  message.set_shape(std::string(model::to_string(plan.object.shape.kind)));
  put(*message.mutable_size(), plan.object.shape.size);
  message.set_mass(plan.object.mass);
  message.set_material(plan.object.material);
  message.set_seed(plan.options.seed);
  message.set_candidates(static_cast<std::uint32_t>(plan.options.candidates));
  message.set_table(plan.options.table);
  message.set_tested(static_cast<std::uint32_t>(plan.options.tested));
  message.set_most_tested(static_cast<std::uint32_t>(plan.options.max_tested));
  message.set_closed(static_cast<std::uint32_t>(plan.closed));
  for (const auto& [reason, count] : plan.refused)
    (*message.mutable_refused())[reason] = static_cast<std::uint32_t>(count);
  message.set_reason(plan.reason);
  for (const PlannedGrasp& planned : plan.grasps) put(*message.add_grasps(), planned);
  // Maps are written in any order unless asked for the same one.
  std::string bytes;
  google::protobuf::io::StringOutputStream stream(&bytes);
  google::protobuf::io::CodedOutputStream coded(&stream);
  coded.SetSerializationDeterministic(true);
  message.SerializeToCodedStream(&coded);
  coded.Trim();
  return bytes;
}

Expected<Plan> parse_plan(const std::string& bytes) {
  messages::SavedPlan message;
  if (!message.ParseFromString(bytes)) return fail("are no planned grasps");
  Plan plan;
  plan.hand = message.hand();
  plan.object.name = message.object();
  const auto shape = model::shape_from_string(message.shape());
  const auto size = numbers(message.size(), 3, "size of the object");
  if (!size) return tl::unexpected(size.error());
  if (!shape) return fail("is of no known shape", "object");
  plan.object.shape = {*shape, *size};
  if (!model::is_valid(plan.object.shape)) return fail("has no valid shape", "object");
  plan.object.mass = message.mass();
  if (!std::isfinite(plan.object.mass) || !(plan.object.mass > 0))
    return fail("mass must be positive", "object");
  plan.object.material = message.material();
  if (!analysis::material_from_string(plan.object.material))
    return fail("unknown material", "object");
  plan.options.seed = message.seed();
  constexpr std::uint32_t most = 1u << 30;
  if (std::max({message.candidates(), message.tested(), message.most_tested(), message.closed()}) >
          most ||
      message.grasps_size() > max_grasps)
    return fail("counts are out of range", "plan");
  plan.options.candidates = static_cast<int>(message.candidates());
  plan.options.table = message.table();
  plan.options.tested = static_cast<int>(message.tested());
  plan.options.max_tested = static_cast<int>(message.most_tested());
  plan.closed = static_cast<int>(message.closed());
  for (const auto& [reason, count] : message.refused())
    plan.refused[reason] = static_cast<int>(std::min(count, most));
  plan.reason = message.reason();
  for (const messages::SavedGrasp& saved : message.grasps()) {
    auto read = grasp(saved);
    if (!read) return tl::unexpected(read.error());
    plan.grasps.push_back(std::move(*read));
  }
  return plan;
}

Expected<void> save(const std::filesystem::path& file, const Plan& plan) {
  return proto::write_sealed(file, kind, serialise(plan));
}

Expected<Plan> load_plan(const std::filesystem::path& file) {
  auto bytes = proto::read_sealed(file, kind);
  if (!bytes) return tl::unexpected(bytes.error());
  auto plan = parse_plan(*bytes);
  if (!plan) {
    Error error = plan.error();
    error.where = file.string() + (error.where.empty() ? "" : ": " + error.where);
    if (error.hint.empty()) error.hint = "plan the grasps again: prehend grasp plan";
    return tl::unexpected(std::move(error));
  }
  return plan;
}

}  // namespace prehend::planner
