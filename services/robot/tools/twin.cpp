#include "services/robot/tools/twin.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include "common/convert/convert.hpp"
#include "common/dds/participant.hpp"
#include "common/dds/topics.hpp"
#include "common/service/membership.hpp"

namespace prehend::robot {
namespace {

constexpr Duration period = std::chrono::milliseconds(8);

Time now() {
  return std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
}

}  // namespace

Eigen::VectorXd drives_of(const model::HandModel& hand, const std::vector<double>& joints) {
  Eigen::VectorXd drives(static_cast<Eigen::Index>(hand.dofs().size()));
  for (std::size_t d = 0; d < hand.dofs().size(); ++d)
    drives[static_cast<Eigen::Index>(d)] = joints[static_cast<std::size_t>(hand.dofs()[d].joint)];
  for (std::size_t j = 0; j < hand.joints().size(); ++j) {
    const model::HandJoint& joint = hand.joints()[j];
    if (hand.dofs()[static_cast<std::size_t>(joint.dof)].closing <= 0) continue;
    double& drive = drives[joint.dof];
    drive = std::max(drive, (joints[j] - joint.offset) / joint.multiplier);
  }
  return drives;
}

struct Twin::State {
  const model::HandModel& hand;
  std::string name, twin;
  dds::Participant participant;
  dds::Reader<v2::HandCommand> commands;
  dds::Reader<v1::HandState> states;
  dds::Writer<v2::HandCommand> drives;
  std::optional<v2::HandCommand> command;  // the robot's last one, for what mapping thought of it
  std::optional<v1::HandState> carried;    // the robot's last word of where its base is
  std::uint64_t sequence = 0;
  std::int64_t origin_ns = 0;  // of the last drive
  Time next{};

  void hear(Emulator& robot) {
    for (const auto& sample : commands.take())
      if (!sample.info.gone && sample.data.hand().to_string() == name) command = sample.data;
    for (const auto& sample : states.take()) {
      if (sample.info.gone) continue;
      const std::string whose = sample.data.hand().to_string();
      if (whose == twin && sample.data.joint().size() == hand.joints().size())
        robot.measure(drives_of(hand, sample.data.joint()));
      if (whose == name && sample.data.origin_ns() != 0) carried = sample.data;
    }
  }

  void drive(const Emulator& robot) {
    if (!command || !carried || now() < next) return;
    next = now() + period;
    v2::HandCommand driven = *command;
    driven.hand(twin);
    driven.sequence_number(++sequence);
    driven.stamp_ns(to_ns(now()));
    // What is said again answers no new frame.
    driven.origin_ns(std::exchange(origin_ns, carried->origin_ns()) == carried->origin_ns()
                         ? 0
                         : carried->origin_ns());
    driven.dof(convert::to_message(hand.clamp(robot.driven())));
    driven.effort().clear();
    driven.X_WB(carried->X_WB());
    (void)drives.write(driven);
  }
};

Twin::Twin(std::unique_ptr<State> state) : state_(std::move(state)) {}
Twin::~Twin() = default;

Expected<std::unique_ptr<Twin>> Twin::create(const service::Config& config,
                                             const model::HandModel& hand, const std::string& name,
                                             const std::string& twin) {
  if (name == twin) return wrong_use("the twin needs a name of its own", "--twin", "give twin");
  if (!config.text("lab.keys").empty())
    return wrong_use("the twin of an emulated robot cannot join a lab with keys", "lab.keys",
                     "emulate without --twin, or leave the keys out");
  auto participant =
      dds::Participant::create(service::membership(config, "emulated-robot", "mapping"));
  if (!participant) return tl::unexpected(participant.error());
  auto commands = participant->reader(dds::robot_command);
  if (!commands) return tl::unexpected(commands.error());
  auto states = participant->reader(dds::robot_state);
  if (!states) return tl::unexpected(states.error());
  auto drives = participant->writer(dds::robot_command);
  if (!drives) return tl::unexpected(drives.error());
  return std::unique_ptr<Twin>(new Twin(std::make_unique<State>(State{hand,
                                                                      name,
                                                                      twin,
                                                                      std::move(*participant),
                                                                      std::move(*commands),
                                                                      std::move(*states),
                                                                      std::move(*drives),
                                                                      {},
                                                                      {},
                                                                      0,
                                                                      {}})));
}

void Twin::exchange(Emulator& robot) {
  state_->hear(robot);
  state_->drive(robot);
}

}  // namespace prehend::robot
