#include "tests/integration/safety_rig.hpp"

namespace prehend::integration {

using Eigen::Vector3d;
using std::chrono::milliseconds;

v2::HandCommand SafetyRig::command(const Vector3d& p) {
  v2::HandCommand message;
  message.hand("hand");
  message.model("barrett");
  message.sequence_number(++sequence_);
  message.stamp_ns(now_ns());
  message.origin_ns(now_ns());
  message.dof({0, 0, 0, 0});
  message.X_WB(convert::to_message(make_pose(p)));
  return message;
}

void SafetyRig::listen() {
  for (auto& sample : states_.take()) {
    if (sample.info.gone) continue;
    const v1::HandState& next = sample.data;
    const double t = 1e-9 * static_cast<double>(next.stamp_ns() - state_.stamp_ns());
    if (heard_ > 0 && t > 0) {
      const Vector3d p = convert::from_message(next.X_WB().position());
      base_speed_ = std::max(base_speed_, (p - base()).norm() / t);
      for (std::size_t i = 0; i < next.dof().size(); ++i)
        dof_speed_ = std::max(dof_speed_, std::abs(next.dof()[i] - state_.dof()[i]) / t);
    }
    state_ = next;
    ++heard_;
  }
  for (auto& sample : gates_.take())
    if (!sample.info.gone) gate_ = sample.data;
  for (auto& sample : statuses_.take())
    if (!sample.info.gone && sample.data.name().to_string() == "simulation") status_ = sample.data;
}

bool SafetyRig::send(dds::Writer<v2::HandCommand>& writer, double limit_s,
                     const std::function<v2::HandCommand()>& next,
                     const std::function<bool()>& condition) {
  return eventually(limit_s, [&] {
    writer.write(next());
    std::this_thread::sleep_for(milliseconds(20));
    listen();
    return condition();
  });
}

bool SafetyRig::wait(double limit_s, const std::function<bool()>& condition) {
  return eventually(limit_s, [&] {
    listen();
    return condition();
  });
}

void SafetyRig::start_hand(const Strings& sets) {
  simulation_.emplace(start("simulation", sets));
  meet(commands_);
  ASSERT_TRUE(send(
      commands_, 30, [&] { return command(beginning); },
      [&] { return heard_ > 0 && (base() - beginning).norm() < 1e-3; }));
}

void SafetyRig::start_lab(const Strings& sets) {
  scene_ = scene(1);
  Strings all = sets;
  all.push_back("lab.scene=" + scene_);
  simulation_.emplace(start("simulation", all));
  mapping_.emplace(start("mapping"));
  glove_.emplace(start("glove", {"lab.scene=" + scene_}));
  ASSERT_TRUE(wait(40, [&] { return total("leads") == 1 && base_speed_ > 0.01; }));
}

std::uint64_t SafetyRig::total(const std::string& rate) const {
  for (const auto& one : status_.rates())
    if (one.name().to_string() == rate) return one.total();
  return 0;
}

std::uint64_t SafetyRig::dropped(const std::string& reason) const {
  for (const auto& one : status_.drops())
    if (one.reason().to_string() == reason) return one.count();
  return 0;
}

bool SafetyRig::says(const std::string& words) const {
  return status_.state() == v1::STATE_DEGRADED &&
         status_.message().to_string().find(words) != std::string::npos;
}

}  // namespace prehend::integration
