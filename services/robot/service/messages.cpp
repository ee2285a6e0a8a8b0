#include "services/robot/service/messages.hpp"

#include "common/convert/convert.hpp"

namespace prehend::robot {

v1::HandState to_message(const Reading& reading, const model::HandModel& hand, const Pose& X_WB) {
  const auto count = static_cast<Eigen::Index>(hand.joints().size());
  Eigen::VectorXd velocity(count), torque = Eigen::VectorXd::Zero(count);
  for (Eigen::Index j = 0; j < count; ++j) {
    const model::HandJoint& joint = hand.joints()[static_cast<std::size_t>(j)];
    velocity[j] = reading.velocity[joint.dof] * joint.multiplier;
    if (hand.dofs()[static_cast<std::size_t>(joint.dof)].joint == j)
      torque[j] = reading.effort[joint.dof];
  }
  v1::HandState message;
  message.model(hand.name());
  message.stamp_ns(to_ns(reading.stamp));
  message.dof(convert::to_message(reading.dof));
  message.joint(convert::to_message(hand.joint_angles(reading.dof)));
  message.velocity(convert::to_message(velocity));
  message.torque(convert::to_message(torque));
  message.X_WB(convert::to_message(X_WB));
  return message;
}

}  // namespace prehend::robot
