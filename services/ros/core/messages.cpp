#include "services/ros/core/messages.hpp"

#include <utility>

namespace prehend::ros {
Bytes tf_message(const std::vector<Transform>& transforms) {
  ros2::CdrWriter made;
  made.put(static_cast<std::uint32_t>(transforms.size()));
  for (const Transform& transform : transforms) {
    made.stamp(transform.stamp_ns);
    made.put(transform.parent);
    made.put(transform.child);
    made.put(transform.X_PC);
  }
  return std::move(made).bytes();
}

Bytes text_message(std::string_view text) {
  ros2::CdrWriter made;
  made.put(text);
  return std::move(made).bytes();
}

std::vector<Transform> transforms_of(const model::HandModel& model, const Pose& X_WB,
                                     const Eigen::VectorXd& joints, std::string_view table,
                                     std::int64_t stamp_ns) {
  const std::vector<Pose> X_BL = model.link_poses(joints);
  std::vector<Transform> made{{stamp_ns, std::string(table), model.links()[0].name, X_WB}};
  for (const model::HandJoint& joint : model.joints()) {
    const auto parent = static_cast<std::size_t>(joint.parent);
    const auto child = static_cast<std::size_t>(joint.child);
    made.push_back({stamp_ns, model.links()[parent].name, model.links()[child].name,
                    X_BL[parent].inverse() * X_BL[child]});
  }
  return made;
}

}  // namespace prehend::ros
