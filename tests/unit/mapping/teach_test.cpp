// Teaching by showing: a synthetic person who moves from posture to posture teaches every hand's
// scheme; what moves, or looks like another posture, is not taken. Distances are those of
// TeachOptions; the tracker's noise here is 1 mm a coordinate, filtered as the glove does to 0.3
// mm.
#include "services/mapping/tools/training/teach.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/mapping/tools/training/demonstrator.hpp"
#include "services/mapping/tools/training/trainer.hpp"
#include "tests/support/paths/paths.hpp"
#include "tests/unit/mapping/fixtures.hpp"

namespace prehend::mapping {
namespace {

constexpr Duration frame = std::chrono::milliseconds(33);

DemonstratorOptions filtered() {
  DemonstratorOptions options;
  options.noise = 0.0003;
  return options;
}

/// Someone who does what is asked, and how long it took.
class Pupil {
 public:
  explicit Pupil(std::uint64_t seed) : person_("pupil", seed, filtered()) {}

  /// Goes there in half a second and stays until the posture is taken; none if it is not within
  /// five seconds.
  std::optional<Shown> show(Teacher& teacher, const SchemePosture& posture) {
    const Closure goal = person_.repeat(posture.human);
    std::optional<Shown> taken;
    for (int i = 1; i <= 150 && !taken; ++i) {
      const double share = std::min(1.0, i / 15.0);
      Closure now{};
      for (std::size_t f = 0; f < now.size(); ++f)
        now[f] = from_.human[f] + share * (goal[f] - from_.human[f]);
      now_ += frame;
      taken =
          teacher.see(person_.read(now, from_.splay + share * (posture.splay - from_.splay)), now_);
    }
    from_.human = goal;
    from_.splay = posture.splay;
    return taken;
  }
  double seconds() const { return to_seconds(now_.time_since_epoch()); }

 private:
  Demonstrator person_;
  SchemePosture from_{"", {0.3, 0.3, 0.3, 0.3, 0.3}, 0, {}};
  Time now_{};
};

Scheme scheme_of(const std::string& name, const model::HandModel& hand) {
  return *Scheme::load(test::in_sources("services/mapping/schemes/") + name + ".toml", hand);
}

class TeachEveryHand : public testing::TestWithParam<std::string> {};

TEST_P(TeachEveryHand, TakesAllPosturesOfAPersonInLessThanAMinute) {
  const auto hand = model::HandModel::load(test::in_sources("common/models/hands/") + GetParam());
  ASSERT_TRUE(hand);
  const Scheme scheme = scheme_of(GetParam(), *hand);
  Teacher teacher(curriculum(*hand, scheme, "pupil", 1, 7, {}), {});
  Pupil pupil(4);
  for (const SchemePosture& posture : scheme.posture_set(7)) {
    ASSERT_TRUE(teacher.asked());
    EXPECT_EQ(teacher.asked()->posture, posture.name);
    const auto shown = pupil.show(teacher, posture);
    ASSERT_TRUE(shown) << posture.name << ": " << teacher.waiting_for();
    EXPECT_GE(shown->quality, 0);
    EXPECT_LE(shown->quality, 1);
    EXPECT_EQ(shown->pair.dof, posture.robot);
  }
  EXPECT_FALSE(teacher.asked());
  EXPECT_LT(pupil.seconds(), 60);
  const learning::TrainingSet set = taught_set(*hand, scheme, teacher.shown());
  EXPECT_TRUE(learning::check(set));
  EXPECT_TRUE(check_consistent(set));
}

INSTANTIATE_TEST_SUITE_P(All, TeachEveryHand, testing::ValuesIn(test::mappable_hands()),
                         [](const auto& given) { return given.param; });

class TeachBarrett : public testing::Test {
 protected:
  Scheme scheme_ = scheme_of("barrett", barrett());
  std::vector<SchemePosture> postures_ = scheme_.posture_set(7);
  Teacher teacher_{curriculum(barrett(), scheme_, "pupil", 2, 7, {}), {}};
};

TEST_F(TeachBarrett, WaitsForAHandThatMoves) {
  Demonstrator person("someone", 1, filtered());
  for (int i = 0; i < 200; ++i) {
    const double closure = 0.5 + 0.4 * std::sin(0.1 * i);
    EXPECT_FALSE(
        teacher_.see(person.read({closure, closure, closure, closure, closure}), Time(i * frame)));
  }
  EXPECT_EQ(teacher_.waiting_for(), "keep still");
}

TEST_F(TeachBarrett, DoesNotTakeOnePostureForTwo) {
  Pupil pupil(2);
  ASSERT_TRUE(pupil.show(teacher_, postures_[0]));
  EXPECT_FALSE(pupil.show(teacher_, postures_[0]));
  EXPECT_THAT(teacher_.waiting_for(), testing::HasSubstr("«open»"));
  EXPECT_TRUE(pupil.show(teacher_, postures_[1]));
  // Neither does it take an older one again.
  EXPECT_FALSE(pupil.show(teacher_, postures_[0]));
  EXPECT_EQ(teacher_.waiting_for(), "too much like «open»");
}

TEST_F(TeachBarrett, ShowsTheLastOneAgain) {
  EXPECT_FALSE(teacher_.redo());
  Pupil pupil(3);
  ASSERT_TRUE(pupil.show(teacher_, postures_[0]));
  ASSERT_TRUE(pupil.show(teacher_, postures_[2]));  // the wrong one: thumb closed, not half
  EXPECT_TRUE(teacher_.redo());
  EXPECT_EQ(teacher_.asked()->posture, "thumb half");
  const auto again = pupil.show(teacher_, postures_[1]);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->pair.posture, "thumb half");
  EXPECT_EQ(teacher_.shown().size(), 2u);
}

TEST_F(TeachBarrett, AsksForEveryTake) {
  Pupil pupil(5);
  for (int take = 0; take < 2; ++take)
    for (const SchemePosture& posture : postures_) {
      const auto shown = pupil.show(teacher_, posture);
      ASSERT_TRUE(shown) << take << posture.name << teacher_.waiting_for();
      EXPECT_EQ(shown->pair.take, static_cast<unsigned>(take));
    }
  EXPECT_FALSE(teacher_.asked());
}

TEST_F(TeachBarrett, ContradictionsAreNamed) {
  Pupil pupil(6);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(pupil.show(teacher_, postures_[i]));
  learning::TrainingSet set = taught_set(barrett(), scheme_, teacher_.shown());
  ASSERT_TRUE(check_consistent(set));
  set.pairs.push_back(set.pairs.front());
  EXPECT_TRUE(check_consistent(set)) << "the same answer twice is no contradiction";
  set.pairs.back().posture = "thumb closed";
  set.pairs.back().dof = postures_[2].robot;
  const auto refused = check_consistent(set);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message(), testing::HasSubstr("pairs 0 (open) and 3 (thumb closed)"));
}

// What one person taught is answered the way it was taught, also where no object is known: pairs
// without an object belong to the direct network and to each shape's sizes.
TEST_F(TeachBarrett, TaughtPosturesTrainADirectMapping) {
  Pupil pupil(7);
  for (const SchemePosture& posture : postures_) ASSERT_TRUE(pupil.show(teacher_, posture));
  const learning::TrainingSet set = taught_set(barrett(), scheme_, teacher_.shown());
  TrainerOptions options;
  options.network.hidden = 4;
  const auto model = train_mapping(
      barrett(), scheme_, {set, set, set}, options,
      [](std::size_t count, const auto& work) {
        for (std::size_t i = 0; i < count; ++i) work(i);
      },
      [](auto, auto) {});
  ASSERT_TRUE(model) << model.error().message();
  EXPECT_EQ(model->networks().size(), 1u);
  for (const learning::TrainingPair& pair : set.pairs)
    EXPECT_LT((model->direct(Features(pair.features)).dof - pair.dof).cwiseAbs().maxCoeff(), 0.26)
        << pair.posture;  // 15 degrees: seven points, four neurons
}

}  // namespace
}  // namespace prehend::mapping
