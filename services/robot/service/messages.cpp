#include "services/robot/service/messages.hpp"

#include "common/convert/convert.hpp"
#include "services/robot/core/tip_pressure.hpp"

namespace prehend::robot {

v1::HandState to_message(const Reading& reading, const model::HandModel& hand, const Pose& X_WB) {
  const auto count = static_cast<Eigen::Index>(hand.joints().size());
  Eigen::VectorXd velocity(count), torque = Eigen::VectorXd::Zero(count);
  for (Eigen::Index j = 0; j < count; ++j) {
    const model::HandJoint& joint = hand.joints()[static_cast<std::size_t>(j)];
    velocity[j] = reading.velocity[joint.dof] * joint.multiplier;
    if (hand.dofs()[static_cast<std::size_t>(joint.dof)].joint == j)
      torque[j] = reading.effort.size() > joint.dof ? reading.effort[joint.dof] : 0;
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

v1::HandTouch touch_to_message(const Reading& reading, const model::HandModel& hand) {
  constexpr double not_measured = -1;
  v1::HandTouch message;
  message.model(hand.name());
  message.stamp_ns(to_ns(reading.stamp));
  for (const model::HandLink& link : hand.links()) {
    v1::PadTouch pad;
    pad.link(link.name);
    pad.slip(not_measured);
    pad.friction_use(not_measured);
    message.pads().push_back(pad);
  }
  const auto tips = tip_pressures(hand, reading);
  for (std::size_t k = 0; k < tips.size(); ++k) {
    v1::PadTouch& pad = message.pads()[static_cast<std::size_t>(hand.fingertips()[k].link)];
    pad.valid(true);
    pad.touching(tips[k].pressing);
    pad.pressure(tips[k].pressure);
    pad.force_B(convert::to_message(Eigen::Vector3d(-tips[k].pressure * tips[k].way_B)));
    pad.p_BC(convert::to_message(tips[k].p_BT));
  }
  return message;
}

}  // namespace prehend::robot
