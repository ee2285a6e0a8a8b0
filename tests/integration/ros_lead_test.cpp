// A node of ROS 2, of another make than ours, leads the hand of the simulation by trajectories:
// through the gate, until a stop, an empty trajectory or its end.
#include <cstdlib>

#include "common/model/hand_model.hpp"
#include "services/cli/tools/keys/keystore.hpp"
#include "tests/integration/safety_rig.hpp"

namespace prehend::integration {
namespace {

/// In a domain of its own, on a topic of its own.
template <class Base>
class WithNode : public Base {
 protected:
  WithNode() { ::setenv("ROS_DOMAIN_ID", std::to_string(nodes_).c_str(), 1); }
  ~WithNode() override { ::unsetenv("ROS_DOMAIN_ID"); }

  std::string topic() const {
    std::string made = this->name_ + "/joint_trajectory";
    std::replace(made.begin(), made.end(), '-', '_');
    return made;
  }
  std::string poses() const { return topic() + "_of_wrist"; }
  stage::Process lead() {
    return this->start("ros-lead", {"ros.trajectories=" + topic(), "ros.wrist_poses=" + poses()});
  }
  /// What a node is to tell: the DoFs at these values after so many seconds.
  Strings trajectory(double seconds, const std::vector<double>& dof,
                     const std::string& misnamed = {}) const {
    Strings words{std::to_string(nodes_), topic(), std::to_string(seconds)};
    for (std::size_t d = 0; d < dof.size(); ++d) {
      const auto joint = static_cast<std::size_t>(model_.dofs()[d].joint);
      words.push_back(model_.joints()[joint].name + misnamed + "=" + std::to_string(dof[d]));
    }
    return words;
  }
  /// A node tells that.
  void tell(const Strings& words) {
    const Answer told = this->run("cyclone_ros_writer", words, 60);
    ASSERT_EQ(told.exit_code, 0) << told.log;
  }

  const test::DomainLease lease_of_nodes_;
  const int nodes_ = lease_of_nodes_.domain();
  const model::HandModel model_ =
      model::HandModel::load(model::hand_directory(model::lab_hand())).value();
};

class RosLead : public WithNode<SafetyRig> {
 protected:
  /// Listens until the condition holds; of ros-lead's status, too.
  bool wait(double limit_s, const std::function<bool()>& condition) {
    return eventually(limit_s, [&] {
      listen();
      for (auto& sample : said_.take())
        if (!sample.info.gone && sample.data.name().to_string() == "ros-lead") lead_ = sample.data;
      return condition();
    });
  }
  std::uint64_t counted(const std::string& reason) const {
    for (const auto& one : lead_.drops())
      if (one.reason().to_string() == reason) return one.count();
    return 0;
  }
  bool complains(const std::string& words) const {
    return lead_.state() == v1::STATE_DEGRADED &&
           lead_.message().to_string().find(words) != std::string::npos;
  }
  double finger() const { return state_.dof().empty() ? 0 : state_.dof()[dof_]; }
  /// The open hand, but for the DoF that closes it furthest: at this share of its range.
  std::vector<double> closed(double share) const {
    std::vector<double> made = convert::to_message(model_.postures().at("open"));
    made[dof_] = at(share);
    return made;
  }
  double at(double share) const {
    const model::HandDof& dof = model_.dofs()[dof_];
    return dof.lower + share * (dof.upper - dof.lower);
  }
  bool is_at(double share) const {
    return std::abs(finger() - at(share)) <
           0.01 * (model_.dofs()[dof_].upper - model_.dofs()[dof_].lower);
  }
  /// Nobody leads, and the hand stays where it is for so many states.
  void expect_rest(int states) {
    ASSERT_TRUE(wait(30, [&] { return gate_.leader().size() == 0; }));
    const double where = finger();
    double moved = 0;
    ASSERT_TRUE(wait(30, [&, first = heard_] {
      moved = std::max(moved, std::abs(finger() - where));
      return heard_ > first + states;
    }));
    EXPECT_LT(moved, 0.01);
  }

  const std::size_t dof_ = [this] {
    for (std::size_t d = 0; d < model_.dofs().size(); ++d)
      if (model_.dofs()[d].closing != 0) return d;
    throw std::runtime_error("no DoF closes the hand");
  }();
  dds::Reader<v1::ServiceStatus> said_ = reader(dds::service_status);
  v1::ServiceStatus lead_;
};

TEST_F(RosLead, ANodeLeadsTheHandThroughTheGate) {
  simulation_.emplace(start("simulation"));
  auto leader = lead();
  ASSERT_TRUE(wait(60, [&] { return heard_ > 0 && lead_.state() == v1::STATE_RUNNING; }))
      << lead_.message().to_string();
  const Eigen::Vector3d before = base();

  // Followed from point to point, the base where it was.
  tell(trajectory(1, closed(0.4)));
  bool between = false;
  ASSERT_TRUE(wait(40,
                   [&] {
                     between |= finger() > at(0.1) && finger() < at(0.3);
                     return is_at(0.4);
                   }))
      << finger() << " " << lead_.message().to_string();
  EXPECT_TRUE(between);
  EXPECT_LT((base() - before).norm(), 1e-3);
  EXPECT_TRUE(wait(20, [&] { return gate_.leader().to_string().starts_with("ros-lead@"); }))
      << gate_.leader().to_string();

  // What is wrong is counted, told, and moves nothing: the last point is held.
  tell(trajectory(1, closed(0.1), "_x"));
  ASSERT_TRUE(wait(20, [&] { return counted("trajectory refused") == 1; }));
  EXPECT_TRUE(complains("was refused: does not name the joint")) << lead_.message().to_string();
  EXPECT_TRUE(is_at(0.4)) << finger();

  // A stop ends it, and the release does not bring it back.
  tell(trajectory(30, closed(0.9)));
  ASSERT_TRUE(wait(40, [&] { return finger() > at(0.45); })) << lead_.message().to_string();
  EXPECT_EQ(run("prehend", with_lab({"stop", "--reason", "a test"}), 30).exit_code, 0);
  ASSERT_TRUE(wait(20, [&] { return counted("trajectory ended") == 1; }));
  EXPECT_TRUE(complains("is stopped by")) << lead_.message().to_string();
  EXPECT_EQ(run("prehend", with_lab({"release", "--reason", "the test goes on"}), 30).exit_code, 0);
  ASSERT_TRUE(wait(20, [&] { return !gate_.stopped(); }));
  ASSERT_NO_FATAL_FAILURE(expect_rest(50));
  EXPECT_LT(finger(), at(0.9));

  // An empty one ends the lead, too.
  tell(trajectory(30, closed(0)));
  const double rest = finger();
  ASSERT_TRUE(wait(40, [&] { return finger() < rest - 0.02; })) << lead_.message().to_string();
  tell(trajectory(0, {}));
  ASSERT_NO_FATAL_FAILURE(expect_rest(50));
  EXPECT_GT(finger(), at(0.05));
  EXPECT_TRUE(wait(20, [&] { return lead_.state() == v1::STATE_RUNNING; }));
  EXPECT_EQ(leader.stop(seconds(10)).code, 0);
}

// A pose of the wrist leads the base, as fast as the gate allows; the fingers stay where they are.
TEST_F(RosLead, ANodeLeadsTheBaseByPoses) {
  simulation_.emplace(start("simulation"));
  auto leader = lead();
  ASSERT_TRUE(wait(60, [&] { return heard_ > 0 && lead_.state() == v1::STATE_RUNNING; }))
      << lead_.message().to_string();
  const double closed = finger();
  const Eigen::Vector3d goal = base() + Eigen::Vector3d(0.1, -0.1, 0.2);
  const auto to = [&](const std::string& frame, int count, const Eigen::Vector3d& p) {
    return Strings{std::to_string(nodes_),
                   poses(),
                   frame,
                   std::to_string(count),
                   std::to_string(p.x()),
                   std::to_string(p.y()),
                   std::to_string(p.z())};
  };
  const auto is_there = [&] { return (base() - goal).norm() < 2e-3; };

  // In another frame: one line, and nothing moves.
  ASSERT_EQ(run("cyclone_ros_pose", to("base_link", 1, goal), 60).exit_code, 0);
  ASSERT_TRUE(wait(20, [&] { return counted("wrist pose refused") == 1; }));
  EXPECT_TRUE(complains("is in the frame «base_link»")) << lead_.message().to_string();
  EXPECT_EQ(gate_.leader().size(), 0U) << gate_.leader().to_string();

  // One node streams, a second one is refused meanwhile.
  auto first = start_program("cyclone_ros_pose", to("table", 500, goal));
  ASSERT_TRUE(wait(60, [&] { return gate_.leader().to_string().starts_with("ros-lead@"); }));
  auto second =
      start_program("cyclone_ros_pose", to("table", 20, goal + Eigen::Vector3d(0.3, 0, 0)));
  EXPECT_TRUE(wait(60, [&] { return first.exit() && is_there(); })) << base().transpose();
  EXPECT_TRUE(wait(20, [&] { return counted("wrist pose refused") > 1; }));
  EXPECT_TRUE(is_there()) << base().transpose();
  EXPECT_NEAR(finger(), closed, 0.02);
  // Held after the last one, until somebody ends it.
  EXPECT_TRUE(gate_.leader().to_string().starts_with("ros-lead@"));
  tell(trajectory(0, {}));
  ASSERT_NO_FATAL_FAILURE(expect_rest(50));
}

// It takes the hand from nobody; what was refused then is not taken up later, either.
TEST_F(RosLead, WhoLeadsAlreadyKeepsTheHand) {
  simulation_.emplace(start("simulation", patient));
  auto leader = lead();
  meet(commands_);
  const auto ours = [&] {
    v2::HandCommand message = command(beginning);
    message.model(model_.name());
    message.dof(closed(0.2));
    return message;
  };
  const auto lead_until = [&](const std::function<bool()>& condition) {
    return send(commands_, 60, ours, [&] { return wait(0, condition); });
  };
  ASSERT_TRUE(lead_until([&] { return is_at(0.2) && complains("is led by"); }))
      << lead_.message().to_string();
  auto node = start_program("cyclone_ros_writer", trajectory(0.1, closed(0.6)));
  ASSERT_TRUE(lead_until([&] { return counted("trajectory refused") == 1 && node.exit(); }));
  ASSERT_NO_FATAL_FAILURE(expect_rest(50));
  EXPECT_TRUE(is_at(0.2)) << finger();
}

class SecuredRosLead : public WithNode<Rig> {};

// With a performer's keys; but not for a network where anybody may be a node.
TEST_F(SecuredRosLead, LeadsWithKeysForThisMachineAlone) {
  const auto keys = cli::Keystore::init(folder_ / "keys", std::chrono::days(365), from_ns(now_ns()),
                                        {name_, domain_});
  ASSERT_TRUE(keys) << keys.error().message();
  network_.keys = keys->folder();
  const Answer open = run("prehend-ros-lead", lab_arguments({"ros.network=lan"}), 30);
  EXPECT_EQ(open.exit_code, 2) << open.log;
  EXPECT_NE(open.log.find("ros.network: would let anybody"), std::string::npos) << open.log;

  join("viewer");
  auto gates = reader(dds::robot_gate);
  auto statuses = reader(dds::service_status);
  auto simulation = start("simulation");
  auto leader = lead();
  ASSERT_TRUE(hear<v1::ServiceStatus>(statuses, 60, [](const auto& status) {
    return status.name().to_string() == "ros-lead" && status.state() == v1::STATE_RUNNING;
  }));
  tell(trajectory(1, convert::to_message(model_.postures().at("open"))));
  EXPECT_TRUE(hear<v1::GateState>(gates, 40, [](const auto& gate) {
    return gate.leader().to_string().starts_with("ros-lead@") && gate.obeyed() > 0;
  }));
}

}  // namespace
}  // namespace prehend::integration
