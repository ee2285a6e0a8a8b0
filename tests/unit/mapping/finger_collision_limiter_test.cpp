// Fingers that meet. find_blocking (common/grasping), which moves the exact collision shapes in
// Bullet, is the judge of which finger lies on which and in what order they open; the mapping must
// come to the same by its capsules. Joint values are compared to 1e-9, sums of a few hundred steps;
// 1e-5 m is ten times what FingerCollisionLimiter takes for rounding.
#include "services/mapping/core/finger_collision_limiter.hpp"

#include <gtest/gtest.h>

#include "common/grasping/blocking.hpp"
#include "services/mapping/core/mapping.hpp"
#include "services/mapping/tools/training/scheme.hpp"
#include "tests/support/paths/paths.hpp"
#include "tests/unit/mapping/fixtures.hpp"

namespace prehend::mapping {
namespace {

using Eigen::VectorXd;

/// Every scheme with its hand.
struct Case {
  std::string scheme, hand;
};

const std::vector<Case> cases{{"barrett", "barrett"},
                              {"barrett_fixed_spread", "barrett"},
                              {"barrett_alternative_1", "barrett"},
                              {"dlr", "dlr"},
                              {"robonaut", "robonaut"},
                              {"rutgers", "rutgers"},
                              {"parallel_jaw", "parallel_jaw"}};

class EveryFinger : public testing::TestWithParam<Case> {
 protected:
  const model::HandModel& hand_ = test::hand(GetParam().hand);
  Scheme scheme_ =
      Scheme::load(test::in_sources("services/mapping/schemes/") + GetParam().scheme + ".toml",
                   hand_)
          .value();
  FingerCollisionLimiter limiter_{hand_};

  VectorXd anywhere(Random& random) const {
    VectorXd dof = scheme_.lower;
    for (Eigen::Index i = 0; i < dof.size(); ++i)
      dof[i] = random.uniform(scheme_.lower[i], scheme_.upper[i]);
    return dof;
  }
  /// One command toward a target, 30 times a second, no faster than the joints may.
  VectorXd command(const VectorXd& now, const VectorXd& target) const {
    VectorXd next = now;
    for (Eigen::Index i = 0; i < now.size(); ++i) {
      const double most = hand_.dofs()[static_cast<std::size_t>(i)].max_velocity / 30;
      next[i] += std::clamp(target[i] - now[i], -most, most);
    }
    return limiter_.go(now, next);
  }
  int finger(int link) const { return hand_.links()[static_cast<std::size_t>(link)].finger; }
  /// What closes these fingers (a bit each), opened.
  VectorXd opened(VectorXd dof, unsigned fingers) const {
    const VectorXd& open = hand_.postures().at("open");
    for (const model::HandJoint& joint : hand_.joints()) {
      const int of = finger(joint.child);
      const auto& closes = hand_.dofs()[static_cast<std::size_t>(joint.dof)];
      if (of >= 0 && (fingers >> of & 1U) && closes.closing != 0) dof[joint.dof] = open[joint.dof];
    }
    return dof;
  }
  VectorXd after(VectorXd now, const VectorXd& target, int commands = 300) const {
    for (int i = 0; i < commands; ++i) now = command(now, target);
    return now;
  }
};

TEST_P(EveryFinger, GoesWhereNoOtherIs) {
  // All that people show of the basic postures is reached as if fingers could pass each other.
  for (const SchemePosture& posture : scheme_.posture_set(13))
    EXPECT_TRUE(after(scheme_.open.robot, posture.robot).isApprox(posture.robot, 1e-9))
        << posture.name;
}

// From anywhere within the scheme's limits: fingers can always be opened one after the other, and a
// finger that another one blocks waits for it.
TEST_P(EveryFinger, NeverInterlocksAndOpensWhatLiesOnTopFirst) {
  Random random(3);
  VectorXd now = scheme_.open.robot;
  int locks = 0;
  for (int i = 0; i < 60; ++i) {
    const VectorXd target = anywhere(random);
    for (int k = 0; k < 25; ++k) {
      now = command(now, target);
      ASSERT_GE(limiter_.clearance(now), -1e-5);
    }
    const auto found = grasping::find_blocking(hand_, hand_.joint_angles(now));
    ASSERT_TRUE(found) << found.error().message();
    EXPECT_TRUE(found->order) << grasping::to_string(*found, hand_) << "\n" << now.transpose();
    for (const grasping::LinkPair& pair : found->blocked) {
      const int below = finger(pair.link), above = finger(pair.other);
      const VectorXd stuck = opened(now, ~(1U << above)), first = opened(now, 1U << above);
      EXPECT_FALSE(after(now, stuck).isApprox(stuck, 1e-9)) << grasping::to_string(*found, hand_);
      ++locks;
      // Whatever else may lie on the upper finger goes with it.
      const VectorXd both = opened(first, ~0U);
      EXPECT_TRUE(after(after(now, first), both).isApprox(both, 1e-9)) << below;
    }
    const VectorXd open = after(now, scheme_.open.robot);
    EXPECT_TRUE(open.isApprox(scheme_.open.robot, 1e-9)) << now.transpose();
  }
  RecordProperty("locks", locks);
  if (GetParam().scheme == "barrett" || GetParam().scheme == "robonaut") {
    EXPECT_GT(locks, 0) << "nothing was seen";
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryFinger, testing::ValuesIn(cases),
                         [](const auto& given) { return given.param.scheme; });

// A mapping that is started again while the third finger of the Barrett hand lies on another, in
// front of an operator whose hand is open.
TEST(LockedHand, IsOpenedByTheMappingFromTheTop) {
  const FingerCollisionLimiter limiter(barrett());
  VectorXd locked = barrett().postures().at("open");
  std::vector<grasping::LinkPair> blocked;
  for (double spread = 0; spread < 0.8 && blocked.empty(); spread += 0.1)
    for (double closed = 1.6; closed < 2.4 && blocked.empty(); closed += 0.1) {
      const VectorXd below = Eigen::Vector4d(spread, closed, closed, 0);
      locked = limiter.go(limiter.go(Eigen::Vector4d::Zero(), below),
                          below + Eigen::Vector4d(0, 0, 0, 2.4));
      blocked = grasping::find_blocking(barrett(), barrett().joint_angles(locked))->blocked;
    }
  ASSERT_FALSE(blocked.empty());
  const auto dof_of = [](int link) {
    return barrett().links()[static_cast<std::size_t>(link)].finger + 1;  // the spread comes first
  };
  const auto below = dof_of(blocked.front().link), above = dof_of(blocked.front().other);

  MappingNetwork open = random_network(model::ShapeKind::unknown, 1);
  open.output = *learning::Scaling::create(Eigen::Vector4d::Zero(), Eigen::Vector4d::Zero());
  const MappingModel model = *MappingModel::create(barrett(), plain_traits(barrett()), {open});
  Mapping mapping = *Mapping::create(barrett(), model, {});
  const auto at = [](int ms) { return Time(std::chrono::milliseconds(1'700'000'000'000 + ms)); };
  const VectorXd still = VectorXd::Zero(static_cast<Eigen::Index>(barrett().joints().size()));
  ASSERT_TRUE(mapping.on_state({at(0), locked, still, still, Pose::Identity()}));
  std::vector<int> opened(4, -1);
  const double overlap = std::min(0.0, limiter.clearance(locked));
  VectorXd now = locked;
  for (int frame = 0; frame < 150; ++frame) {
    const Time time = at(33 * frame);
    const auto command = mapping.on_posture({time, time, Pose::Identity(), 1, tips({})}, time);
    ASSERT_TRUE(command) << command.error().message();
    now = command->dof;
    EXPECT_GE(limiter.clearance(now), overlap - 1e-5);
    for (std::size_t i = 0; i < opened.size(); ++i)
      if (opened[i] < 0 && now[static_cast<Eigen::Index>(i)] < 1e-9) opened[i] = frame;
  }
  EXPECT_LT(now.cwiseAbs().maxCoeff(), 1e-9) << now.transpose();
  EXPECT_LT(opened[static_cast<std::size_t>(above)], opened[static_cast<std::size_t>(below)]);
}

}  // namespace
}  // namespace prehend::mapping
