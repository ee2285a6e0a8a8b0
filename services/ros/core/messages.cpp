#include "services/ros/core/messages.hpp"

#include <bit>

namespace prehend::ros {
namespace {

/// Each number lies at a multiple of its size behind the encapsulation header.
class Cdr {
 public:
  void put(std::uint32_t value) { number(value); }
  void put(std::int32_t value) { number(static_cast<std::uint32_t>(value)); }
  void put(double value) { number(std::bit_cast<std::uint64_t>(value)); }
  void put(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size() + 1));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
    bytes_.push_back(0);
  }
  template <class T>
  void put(const std::vector<T>& all) {
    put(static_cast<std::uint32_t>(all.size()));
    for (const T& one : all) put(one);
  }
  void stamp(std::int64_t ns) {
    constexpr std::int64_t second = 1'000'000'000;
    const std::int64_t behind = ((ns % second) + second) % second;
    put(static_cast<std::int32_t>((ns - behind) / second));
    put(static_cast<std::uint32_t>(behind));
  }
  void put(const Pose& X) {
    const Eigen::Vector3d p = X.translation();
    const Eigen::Quaterniond q(X.rotation());
    for (const double value : {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()}) put(value);
  }
  void put(const Transform& transform) {
    stamp(transform.stamp_ns);
    put(std::string_view(transform.parent));
    put(std::string_view(transform.child));
    put(transform.X_PC);
  }
  Bytes bytes() && { return std::move(bytes_); }

 private:
  static constexpr std::size_t header = 4;

  template <class Number>
  void number(Number value) {
    while ((bytes_.size() - header) % sizeof(Number) != 0) bytes_.push_back(0);
    for (std::size_t i = 0; i < sizeof(Number); ++i)
      bytes_.push_back(static_cast<std::uint8_t>(value >> (8 * i) & 0xff));
  }

  Bytes bytes_{0, 1, 0, 0};  // plain, little endian
};

}  // namespace

Bytes joint_state(const Joints& joints) {
  Cdr made;
  made.stamp(joints.stamp_ns);
  made.put(std::string_view(joints.frame));
  made.put(joints.names);
  made.put(joints.positions);
  made.put(joints.velocities);
  made.put(joints.efforts);
  return std::move(made).bytes();
}

Bytes tf_message(const std::vector<Transform>& transforms) {
  Cdr made;
  made.put(transforms);
  return std::move(made).bytes();
}

Bytes text_message(std::string_view text) {
  Cdr made;
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
