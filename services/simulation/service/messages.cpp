#include "services/simulation/service/messages.hpp"

#include <algorithm>

#include "common/convert/convert.hpp"

namespace prehend::simulation {
Command from_message(const v2::HandCommand& message, const gate::Place& place) {
  Command command;
  command.stamp = from_ns(message.stamp_ns());
  command.origin = from_ns(message.origin_ns());
  command.model = message.model().to_string();
  command.dof = place.dof;
  command.effort = place.effort;
  command.X_WB = place.X_WB;
  command.mode = static_cast<int>(message.mode());
  command.weight = message.weight();
  command.object = message.object().to_string();
  command.grasp_type = static_cast<int>(message.grasp_type());
  return command;
}

Expected<Sighting> from_message(const v1::ObjectDetection& message,
                                const grasping::CatalogueBodies& catalogue) {
  const auto X_WO = convert::from_message(message.X_WO());
  if (!X_WO) return tl::unexpected(X_WO.error());
  Sighting sighting;
  sighting.X_WO = *X_WO;
  const model::Shape shape{convert::from_message(message.shape()),
                           convert::from_message(message.size())};
  sighting.body = catalogue.seen(message.name().to_string(), shape);
  return sighting;
}

v1::HandState to_message(const grasping::HandMotion& motion) {
  v1::HandState message;
  message.dof(convert::to_message(motion.dof));
  message.joint(convert::to_message(motion.joint));
  message.velocity(convert::to_message(motion.velocity));
  message.torque(convert::to_message(motion.torque));
  message.X_WB(convert::to_message(motion.X_WB));
  return message;
}

v1::HandTouch to_message(const std::vector<PadTouch>& pads, const model::HandModel& hand) {
  v1::HandTouch message;
  message.model(hand.name());
  for (std::size_t i = 0; i < pads.size(); ++i) {
    v1::PadTouch pad;
    pad.link(hand.links()[i].name);
    pad.valid(true);
    pad.touching(pads[i].touching);
    pad.force_B(convert::to_message(pads[i].force_B));
    pad.pressure(pads[i].pressure);
    pad.p_BC(convert::to_message(pads[i].p_BC));
    pad.slip(pads[i].slip);
    pad.friction_use(pads[i].friction_use);
    pad.slipping(pads[i].slipping);
    message.pads().push_back(pad);
  }
  return message;
}

v1::ObjectState to_message(const grasping::Body& body, const grasping::BodyMotion& motion) {
  v1::ObjectState message;
  message.body(body.name);
  message.X_WO(convert::to_message(motion.X_WO));
  message.velocity(convert::to_message(motion.velocity));
  message.angular_velocity(convert::to_message(motion.angular_velocity));
  return message;
}

v1::BodyDescription to_message(const grasping::Body& body) {
  v1::BodyDescription message;
  message.name(body.name);
  message.shape(convert::to_message(body.shape.kind));
  message.size(convert::to_message(body.shape.size));
  message.mass(body.mass);
  message.material(body.material);
  return message;
}

v1::GraspReport to_message(const Closure& closure, const GraspVerdict& verdict,
                           const std::vector<std::string>& hands) {
  v1::GraspReport message;
  message.hand(hands[static_cast<std::size_t>(closure.hand)]);
  message.sequence_number(closure.number);
  message.stamp_ns(to_ns(closure.time));
  message.origin_ns(to_ns(closure.command.origin));
  message.object(closure.object.name);
  message.X_BO(convert::to_message(closure.X_BO));
  message.dof(convert::to_message(closure.dof));
  message.mode(static_cast<v1::MappingMode>(closure.command.mode));
  message.weight(closure.command.weight);
  message.grasp_type(static_cast<v1::GraspType>(closure.command.grasp_type));
  message.believed_object(closure.command.object);
  const std::size_t most = 64;  // of the message
  for (const analysis::Contact& contact : analysis::spread_contacts(closure.contacts, most)) {
    v1::Contact entry;
    const std::string& other = hands[static_cast<std::size_t>(contact.hand)];
    entry.link(contact.hand == closure.hand ? contact.link : other + "/" + contact.link);
    entry.p_OC(convert::to_message(contact.p_OC));
    entry.normal_O(convert::to_message(contact.normal_O));
    entry.friction(contact.friction);
    entry.force(contact.force);
    entry.depth(contact.depth);
    message.contacts().push_back(entry);
  }
  message.epsilon(verdict.quality.epsilon);
  message.volume(verdict.quality.volume);
  message.force_closure(verdict.quality.force_closure);
  const Eigen::VectorXd& weakest = verdict.quality.weakest_direction;
  for (std::size_t i = 0; i < 6; ++i)
    message.weakest_direction()[i] =
        weakest.size() == 6 ? weakest[static_cast<Eigen::Index>(i)] : 0.0;
  message.penetration(verdict.penetration);
  message.held(verdict.hold.held);
  message.slip(verdict.hold.slip);
  message.turn(verdict.hold.turn);
  message.reason(verdict.hold.reason);
  return message;
}

}  // namespace prehend::simulation
