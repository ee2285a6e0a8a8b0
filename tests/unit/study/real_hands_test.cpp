// The trained models on the fingers of real hands (Leap recordings). Guards against people who are
// made up too alike: when synthetic thumbs always lay across the palm, real ones, which rest beside
// it, were outside of what had been shown in three frames of four, and a splayed hand left robot
// hands half to nine tenths closed. The models have seen none of these recordings. Limits: frames
// outside at most one in ten (measured: one in seventy), closing at most a quarter (measured: 0.2),
// about what the scatter of sensors leaves of an open hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "common/base/random.hpp"
#include "services/mapping/files/mapping_model_file.hpp"
#include "services/mapping/tools/study/parts.hpp"
#include "tests/support/paths/paths.hpp"
#include "tests/support/shared_data.hpp"

namespace prehend::mapping {
namespace {

struct Model {
  model::HandModel hand;
  Scheme scheme;
  MappingModel mapping;
};

Model load(const std::string& name) {
  auto hand = model::HandModel::load(test::in_sources("common/models/hands/") + name).value();
  auto scheme =
      Scheme::load(test::in_sources("services/mapping/schemes/") + name + ".toml", hand).value();
  auto mapping = load_mapping_model(test::in_share("trained/") + name + ".mapping", hand).value();
  return {std::move(hand), std::move(scheme), std::move(mapping)};
}

/// How far along the way from the open posture to that of this closed finger, 0 to 1.
double closed_by(const Scheme& scheme, const char* finger, const Eigen::VectorXd& dof) {
  const auto closed = std::find_if(scheme.closed.begin(), scheme.closed.end(),
                                   [&](const SchemePosture& p) { return p.name == finger; });
  const Eigen::VectorXd way = closed->robot - scheme.open.robot;
  return way.dot(dof - scheme.open.robot) / way.squaredNorm();
}

class RealHands : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    auto loaded = load_real_takes(shared_data() / "leap_hand_recordings");
    if (!loaded) GTEST_SKIP() << loaded.error().message();
    takes_ = std::move(*loaded);
  }
  std::vector<RealTake> takes_;
};

TEST_P(RealHands, LieWithinWhatPeopleHaveShownAndOpenTheRobot) {
  const Model model = load(GetParam());
  double frames = 0, outside = 0, splayed = 0, closed = 0;
  for (const RealTake& take : takes_)
    for (const RealTake::Frame& frame : take.frames) {
      const auto seen = features(frame.fingertips, take.hand_scale);
      ASSERT_TRUE(seen) << take.name;
      const NetworkAnswer answer = model.mapping.direct(*seen);
      ++frames;
      outside += answer.extrapolating;
      if (!take.name.starts_with("HandSplay")) continue;
      ++splayed;
      closed += 0.5 * (closed_by(model.scheme, "thumb", answer.dof) +
                       closed_by(model.scheme, "index", answer.dof));
    }
  ASSERT_GT(frames, 1000);
  ASSERT_GT(splayed, 50);
  RecordProperty("outside", std::to_string(outside / frames));
  RecordProperty("closed", std::to_string(closed / splayed));
  EXPECT_LT(outside / frames, 0.1);
  EXPECT_LT(closed / splayed, 0.25);
}

INSTANTIATE_TEST_SUITE_P(All, RealHands, testing::Values("barrett", "dlr", "robonaut"),
                         [](const auto& given) { return std::string(given.param); });

}  // namespace
}  // namespace prehend::mapping
