// Training sets of synthetic people and the networks made of them. The model under test is the one
// that the build has made, judged on people who were in none of its sets.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include "common/grasping/table_closing.hpp"
#include "services/mapping/files/mapping_model_file.hpp"
#include "services/mapping/tools/training/trainer.hpp"
#include "tests/support/paths/paths.hpp"
#include "tests/unit/mapping/fixtures.hpp"

namespace prehend::mapping {
namespace {

const Scheme& scheme() {
  static const Scheme loaded =
      *Scheme::load(test::in_sources("services/mapping/schemes/barrett.toml"), barrett());
  return loaded;
}

const model::Catalogue& catalogue() {
  static const model::Catalogue loaded =
      *model::Catalogue::load(test::in_sources("common/models/objects/catalogue.toml"));
  return loaded;
}

/// As the build has closed the hand.
const std::vector<RobotGrasp>& grasps() {
  static const std::vector<RobotGrasp> closed =
      *load_robot_grasps(test::in_share("trained/barrett.grasps"), barrett());
  return closed;
}

learning::TrainingSet people(std::uint64_t seed, int users, int takes) {
  SetOptions options;
  options.seed = seed;
  options.users = users;
  options.takes = takes;
  options.grasps = static_cast<int>(grasps().size());
  return demonstrate(barrett(), scheme(), grasps(), options);
}

TEST(Approaches, CoverAboveAndSides) {
  const model::Reach reach = barrett().reach();
  EXPECT_EQ(grasping::approaches({model::ShapeKind::cylinder, {0.024, 0.024, 0.105}}, reach).size(),
            2u);
  // Too wide for the hand.
  EXPECT_TRUE(grasping::approaches({model::ShapeKind::cylinder, {0.1, 0.1, 0.1}}, reach).empty());
  for (const Pose& X_OG : grasping::approaches({model::ShapeKind::box, {0.04, 0.123, 0.2}}, reach))
    EXPECT_NEAR(std::abs(X_OG.linear()(0, 1)), 1, 1e-9) << "closes across the only face that fits";
}

// The file of the build is what closing gives: the same grasp, closed again, to the bit.
TEST(RobotGrasps, AreClosedTheSameAgain) {
  const RobotGrasp& made = grasps().front();
  const auto again =
      robot_grasp(barrett(), scheme(), grasping::primitive_of(*catalogue().find(made.object)),
                  made.X_OG, made.type);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->dof, made.dof);
  EXPECT_EQ(again->preshape, made.preshape);
  EXPECT_EQ(again->epsilon, made.epsilon);
  EXPECT_EQ(again->held, made.held);
}

TEST(RobotGrasps, OfAnotherHandOrDamagedAreRefused) {
  const auto refused =
      load_robot_grasps(test::in_share("trained/barrett.grasps"), test::hand("dlr"));
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message(),
              testing::HasSubstr("the hand «barrett», not of this «dlr»"));
  const auto file = std::filesystem::path(testing::TempDir()) / "prehend_grasps_test.grasps";
  ASSERT_TRUE(save_robot_grasps(file, barrett(), grasps()));
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 1);
  EXPECT_FALSE(load_robot_grasps(file, barrett()));
  std::filesystem::remove(file);
  EXPECT_FALSE(load_robot_grasps(file, barrett()));
}

// A hand too small or too weak for the catalogue still has postures that people can show.
TEST(RobotGrasps, MayBeNone) {
  SetOptions options;
  options.users = 2;
  const learning::TrainingSet set = demonstrate(barrett(), scheme(), {}, options);
  std::set<std::string> shown;
  for (const learning::TrainingPair& pair : set.pairs) {
    EXPECT_EQ(pair.shape, "");
    shown.insert(pair.posture);
  }
  for (const SchemePosture& posture : scheme().posture_set())
    EXPECT_TRUE(shown.contains(posture.name)) << posture.name;
}

// What was made for the hand as it was before is not taken for what it is now; who does not say is.
TEST(RobotGrasps, OfTheHandBeforeItChangedAreRefused) {
  const auto file = std::filesystem::path(testing::TempDir()) / "prehend_grasps_before.grasps";
  ASSERT_TRUE(save_robot_grasps(file, barrett(), grasps(), "before"));
  EXPECT_TRUE(load_robot_grasps(file, barrett(), "before"));
  EXPECT_TRUE(load_robot_grasps(file, barrett()));
  const auto refused = load_robot_grasps(file, barrett(), "now");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message(), testing::HasSubstr("as it was before"));
  ASSERT_TRUE(save_robot_grasps(file, barrett(), grasps()));
  EXPECT_TRUE(load_robot_grasps(file, barrett(), "now"));
  std::filesystem::remove(file);
}

TEST(RobotGrasps, AreClosedOnTheObjects) {
  std::map<std::string, int> held;
  std::set<GraspType> types;
  for (const RobotGrasp& grasp : grasps()) {
    EXPECT_TRUE(barrett().clamp(grasp.dof).isApprox(grasp.dof, 1e-6));
    EXPECT_GT(grasp.dof.tail<3>().maxCoeff(), 0.1);
    held[grasp.object] += grasp.held;
    types.insert(grasp.type);
  }
  EXPECT_EQ(types.size(), 3u);
  // Every object that fits can be held in at least one way.
  for (const auto& [object, count] : held) EXPECT_GT(count, 0) << object;
  EXPECT_GE(held.size(), 7u);
}

// Guards against thumbs that pushed the object over before the fingers came: with as much added to
// every joint, those that had a short way were in contact after half of it. The contact of a joint
// lies at way / (way + overshoot) of its straight way past contact; the overshoot is 0.25 of the
// longest way here, so that is 0.8 for every joint but those whose least overshoot (0.1 rad) or
// limit counts. Rounding only.
TEST(PastContact, IsReachedByAllFingersTogether) {
  for (const std::string& name : test::mappable_hands()) {
    const model::HandModel& hand = test::hand(name);
    const Scheme made =
        Scheme::load(test::in_sources("services/mapping/schemes/") + name + ".toml", hand).value();
    const auto closed = load_robot_grasps(test::in_share("trained/") + name + ".grasps", hand);
    ASSERT_TRUE(closed) << closed.error().message();
    int proportional = 0;
    for (const RobotGrasp& grasp : *closed) {
      const auto unit = [&](Eigen::Index i) {
        return model::radian_of(hand.dofs()[static_cast<std::size_t>(i)]);
      };
      const auto way = [&](const Eigen::VectorXd& dof, Eigen::Index i) {
        return grasp.closing[i] * (dof[i] - made.open.robot[i]) / unit(i);
      };
      double longest = 0;
      for (Eigen::Index i = 0; i < grasp.dof.size(); ++i)
        longest = std::max(longest, way(grasp.dof, i));
      const Eigen::VectorXd past = past_contact(hand, grasp, made.open.robot, 0.25 * longest);
      for (Eigen::Index i = 0; i < past.size(); ++i) {
        const model::HandDof& dof = hand.dofs()[static_cast<std::size_t>(i)];
        EXPECT_GE(past[i], dof.lower);
        EXPECT_LE(past[i], dof.upper);
        if (grasp.closing[i] == 0) {
          EXPECT_EQ(past[i], grasp.dof[i]) << name << ": what rests stays";
          continue;
        }
        EXPECT_GE(grasp.closing[i] * (past[i] - grasp.dof[i]), 0) << name << ", " << dof.name;
        const bool at_limit = past[i] == dof.lower || past[i] == dof.upper;
        if (at_limit || 0.25 * way(grasp.dof, i) < 0.1) continue;
        EXPECT_NEAR(way(grasp.dof, i) / way(past, i), 0.8, 1e-9) << name << ", " << dof.name;
        ++proportional;
      }
    }
    EXPECT_GT(proportional, 0) << name;
  }
}

TEST(TrainingSet, HoldsPosturesAndGraspsOfEveryTake) {
  const learning::TrainingSet set = people(5, 2, 2);
  ASSERT_TRUE(learning::check(set));
  std::map<std::string, int> postures;
  std::set<std::string> users;
  for (const learning::TrainingPair& pair : set.pairs) {
    ++postures[pair.posture];
    users.insert(pair.user);
    EXPECT_FALSE(pair.shape.empty());
    EXPECT_TRUE(barrett().clamp(pair.dof).isApprox(pair.dof, 1e-9));
  }
  EXPECT_EQ(users.size(), 2u);
  // Each of the basic postures, beside some grasp.
  for (const SchemePosture& posture : scheme().posture_set())
    EXPECT_GT(postures[posture.name], 0) << posture.name;
  const int shown = postures["power wrap"] + postures["circular sphere"] + postures["precision"];
  EXPECT_GE(shown, 2 * 2 * static_cast<int>(grasps().size()) * 8 / 10);
  EXPECT_GT(postures["on the way to power wrap"], 0);
  // The same people again, and others.
  EXPECT_EQ(learning::serialise(set), learning::serialise(people(5, 2, 2)));
  EXPECT_NE(learning::serialise(set), learning::serialise(people(6, 2, 2)));
}

/// One network after the other, in either order: how the work is divided must not matter.
void in_turn(std::size_t count, const std::function<void(std::size_t)>& work) {
  for (std::size_t i = 0; i < count; ++i) work(i);
}
void backwards(std::size_t count, const std::function<void(std::size_t)>& work) {
  for (std::size_t i = count; i > 0; --i) work(i - 1);
}

TEST(Training, RepeatsBitForBit) {
  const Sets sets{people(1, 2, 1), people(2, 1, 1), people(3, 1, 1)};
  TrainerOptions options;
  options.network.epochs = 60;
  const auto a = train_mapping(barrett(), scheme(), sets, options, in_turn, [](auto, auto) {});
  const auto b = train_mapping(barrett(), scheme(), sets, options, backwards, [](auto, auto) {});
  ASSERT_TRUE(a && b);
  ASSERT_EQ(a->networks().size(), 3u);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t layer = 0; layer < 2; ++layer)
      EXPECT_EQ(a->networks()[i].network.layers()[layer], b->networks()[i].network.layers()[layer]);
}

TEST(TrainingSet, HoldsAsManyGraspsOfATakeAsAsked) {
  SetOptions options;
  options.users = 1;
  options.grasps = 5;
  std::set<std::string> shown;
  for (std::uint64_t seed = 1; seed < 30; ++seed) {
    options.seed = seed;
    int count = 0;
    for (const auto& pair : demonstrate(barrett(), scheme(), grasps(), options).pairs)
      if (grasp_type_from_string(pair.posture)) {
        ++count;
        shown.insert(pair.object + pair.posture);
      }
    EXPECT_LE(count, 5);
    EXPECT_GT(count, 0);
  }
  std::set<std::string> all;
  for (const RobotGrasp& grasp : grasps())
    all.insert(grasp.object + std::string(to_string(grasp.type)));
  EXPECT_EQ(shown, all) << "in the end everything is shown";
}

TEST(Training, RefusesSetsThatDoNotFit) {
  Sets sets{people(1, 1, 1), people(2, 1, 1), people(3, 1, 1)};
  sets.validation.hand = "dlr";
  EXPECT_FALSE(train_mapping(barrett(), scheme(), sets, {}, in_turn, [](auto, auto) {}));
  sets.validation.hand = sets.training.hand;
  for (auto& pair : sets.training.pairs) pair.posture = "open";
  EXPECT_FALSE(train_mapping(barrett(), scheme(), sets, {}, in_turn, [](auto, auto) {}));
}

// The claim of [Thesis, 6.2]: knowing shape and size makes the grasp more exact, on takes not seen
// before.
TEST(TrainedModel, IntelligentErrorIsBelowDirectOnOtherPeople) {
  const auto model = load_mapping_model(test::in_share("trained/barrett.mapping"), barrett());
  ASSERT_TRUE(model) << model.error().message();
  const learning::TrainingSet unseen = people(100, 12, 2);
  for (const auto shape : {model::ShapeKind::cylinder, model::ShapeKind::box}) {
    const Comparison all = compare(*model, unseen, shape, false);
    const Comparison grasping = compare(*model, unseen, shape, true);
    EXPECT_GT(grasping.pairs, 30);
    EXPECT_LT(all.intelligent, all.direct) << to_string(shape);
    EXPECT_LT(grasping.intelligent, grasping.direct) << to_string(shape);
    RecordProperty(std::string(to_string(shape)) + "_direct", std::to_string(grasping.direct));
    RecordProperty(std::string(to_string(shape)) + "_intelligent",
                   std::to_string(grasping.intelligent));
  }
}

// The build trains every hand: its answers stay within the scheme's limits, and the open hand is
// nearer to the scheme's open posture than to any closed one.
TEST(TrainedModel, IsThereForEveryHand) {
  for (const std::string& name : test::mappable_hands()) {
    const model::HandModel& hand = test::hand(name);
    const auto model = load_mapping_model(test::in_share("trained/") + name + ".mapping", hand);
    ASSERT_TRUE(model) << model.error().message();
    EXPECT_GE(model->networks().size(), 2u) << name << ": some shape is known";
    const Scheme made =
        Scheme::load(test::in_sources("services/mapping/schemes/") + name + ".toml", hand).value();
    const Eigen::VectorXd open = model->direct(*features(tips({}), 1)).dof;
    EXPECT_TRUE(open.isApprox(open.cwiseMax(made.lower).cwiseMin(made.upper), 1e-12)) << name;
    for (const SchemePosture& closed : made.closed)
      if (closed.robot != made.open.robot) {
        EXPECT_LT((open - made.open.robot).norm(), (open - closed.robot).norm())
            << name << ", " << closed.name;
      }
  }
}

// An open human hand is an open robot hand: within 10 degrees a finger, whatever is there to grasp.
TEST(TrainedModel, OpensWithTheHand) {
  const auto model = load_mapping_model(test::in_share("trained/barrett.mapping"), barrett());
  ASSERT_TRUE(model);
  const Features open = *features(tips({}), 1);
  EXPECT_LT(model->direct(open).dof.tail<3>().maxCoeff(), 0.175);
  for (const model::CatalogueObject& object : catalogue().objects())
    for (const Pose& X_OG : grasping::approaches(object.shape, barrett().reach()))
      if (const auto answer = model->intelligent(open, object.shape, X_OG)) {
        EXPECT_LT(answer->dof.tail<3>().maxCoeff(), 0.175) << object.name;
      }
}

// Which grasp is made, told from hand alone: people who are in no set grasp every object in every
// way that it can be grasped. At least 90 % right, and no type below 85 %.
TEST(TrainedModel, TellsGraspTypesOfOtherPeople) {
  for (const std::string name : {"barrett", "dlr", "robonaut"}) {
    const model::HandModel& hand = test::hand(name);
    const auto model = load_mapping_model(test::in_share("trained/") + name + ".mapping", hand);
    ASSERT_TRUE(model) << model.error().message();
    std::map<GraspType, std::map<GraspType, int>> confusion;  // made, told
    for (unsigned person = 0; person < 40; ++person) {
      Demonstrator demonstrator("unseen", 7'000'000 + person, {});
      for (const model::CatalogueObject& object : catalogue().objects())
        for (const Pose& X_OG : grasping::approaches(object.shape, hand.reach()))
          for (const GraspType type : types_from(X_OG))
            if (const auto grasp = demonstrator.reach(object.shape, X_OG, type)) {
              const bool precision = model->is_precision(demonstrator.read(grasp->closure));
              ++confusion[type][grasp_type(1.2, grasp->X_OG, precision)];
            }
    }
    int all = 0, right = 0;
    for (auto& [made, told] : confusion) {
      int of_type = 0;
      for (const auto& [type, count] : told) {
        of_type += count;
        RecordProperty(
            name + "_" + std::string(to_string(made)) + "_as_" + std::string(to_string(type)),
            count);
      }
      EXPECT_GE(told[made], 0.85 * of_type) << name << ", " << to_string(made);
      all += of_type;
      right += told[made];
    }
    EXPECT_GT(all, 400) << name;
    EXPECT_GE(right, 0.9 * all) << name << ": " << right << " of " << all;
  }
}

}  // namespace
}  // namespace prehend::mapping
