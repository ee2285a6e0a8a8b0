// A person who does not exist shows tasks to the watcher, who has to understand them: phases, what
// was taken, where it was put; and what is wrong with what was shown is said in one clear line.
#include "services/demonstration/core/observation/watcher.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/paths.hpp"
#include "common/base/random.hpp"
#include "services/demonstration/core/observation/grasp_judge.hpp"
#include "services/demonstration/core/observation/task_prior.hpp"
#include "services/demonstration/core/person/person.hpp"
#include "services/demonstration/tools/training/trainer.hpp"
#include "tests/support/takes/made_takes.hpp"

namespace prehend::demonstration {
namespace {

using testing::HasSubstr;

const Time start = from_ns(1'700'000'000'000'000'000);

model::Catalogue catalogue() {
  return model::Catalogue::load(share_directory() / "models/objects/catalogue.toml").value();
}

/// A talc at the middle of the table, a cup on its left.
model::Scene scene() {
  const model::Catalogue known = catalogue();
  model::Scene made;
  for (const auto& [name, place] : {std::pair{"Talc", Eigen::Vector2d(0.05, 0.1)},
                                    std::pair{"Cup", Eigen::Vector2d(-0.3, 0.15)}}) {
    const double height = model::half_extents(known.find(name)->shape).z();
    made.objects.push_back({name, make_pose({place.x(), place.y(), height})});
  }
  return made;
}

Person person(const std::vector<Transfer>& transfers, std::uint64_t seed = 1) {
  auto made = Person::create(scene(), catalogue(), transfers, seed);
  if (!made) throw std::runtime_error(made.error().message());
  return std::move(*made);
}

Transfer talc_to(double x, double y) {
  return {"Talc", {x, y, model::half_extents(catalogue().find("Talc")->shape).z()}, 0};
}

/// What a watcher is shown, and what may be wrong with it.
struct Showing {
  std::function<bool(double t)> hand = [](double) { return true; };
  std::function<bool(const std::string& object, double t)> object = [](auto&, double) {
    return true;
  };
  double until = 1e9;  // s
  std::vector<TimedSegment> news;
};

SeenHand hand_of(const Person& person, double t, Random& random) {
  const Person::HandThen then = person.hand(t);
  const auto tips = person.model().fingertip_poses(model::HumanHand::posture(then.closure));
  SeenHand made{start + seconds(t), then.X_WH, person.model().scale(), {}};
  made.X_WH.pretranslate(random.normal3(0.001));
  for (const std::size_t f : {0, 1, 4})
    made.p_HF[f] = tips[f].translation() + random.normal3(0.001);
  return made;
}

void show(Watcher& watcher, const Person& person, Showing& showing) {
  Random random(7);
  for (int n = 0; n / 30.0 < std::min(person.duration(), showing.until); ++n) {
    const double t = n / 30.0;
    if (n % 3 == 0)
      for (const Person::ObjectThen& object : person.objects(t))
        if (!object.hidden && showing.object(object.name, t)) {
          Pose X_WO = object.X_WO;
          X_WO.pretranslate(random.normal3(0.002));
          ASSERT_TRUE(watcher.see(SeenObject{start + seconds(t), object.name, object.shape, X_WO}));
        }
    if (showing.hand(t)) {
      ASSERT_TRUE(watcher.see(hand_of(person, t, random), "medium wrap"));
    }
    for (const TimedSegment& each : watcher.news()) showing.news.push_back(each);
  }
}

Expected<Demonstration> shown(const Person& person, Showing& showing) {
  Watcher watcher{WatcherOptions{}};
  EXPECT_TRUE(watcher.begin("TEA", start));
  show(watcher, person, showing);
  return watcher.end(start + seconds(std::min(person.duration(), showing.until)), showing.news);
}

TEST(Watcher, UnderstandsWhatWasTakenAndWhereItWasPut) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Person one = person({talc_to(0.25, -0.05)}, seed);
    Showing showing;
    const auto made = shown(one, showing);
    ASSERT_TRUE(made) << made.error().message();
    ASSERT_EQ(made->steps.size(), 1u);
    const tasks::ShownStep& step = made->steps.front();
    EXPECT_EQ(step.object, "Talc");
    EXPECT_EQ(step.grasp, "medium wrap");
    // Noise of 2 mm, averaged over five pictures and more.
    EXPECT_NEAR(step.X_WO_after.translation().x(), 0.25, 0.005);
    EXPECT_NEAR(step.X_WO_after.translation().y(), -0.05, 0.005);
    EXPECT_NEAR(step.X_WO_before.translation().x(), 0.05, 0.005);
    EXPECT_GT(step.highest, step.X_WO_before.translation().z() + 0.1);
    EXPECT_LT(step.max_tilt, 0.1);
    EXPECT_TRUE(step.X_WR.contains("Cup"));
    const auto grasp = step.X_WO_before.inverse() * step.X_WG_grasped;
    EXPECT_LT(grasp.translation().head<2>().norm(), 0.02) << "the hand grasps around the axis";
  }
}

TEST(Watcher, TellsPhasesWhenTheyAreOverEachOnceAndTruly) {
  const Person one = person({talc_to(0.25, -0.05), {"Cup", {0.2, 0.3, 0.05}, 0}});
  Showing showing;
  const auto made = shown(one, showing);
  ASSERT_TRUE(made) << made.error().message();
  ASSERT_EQ(made->segments.size(), one.truth().size());
  ASSERT_EQ(showing.news.size(), one.truth().size());
  for (std::size_t i = 0; i < one.truth().size(); ++i) {
    EXPECT_EQ(made->segments[i].phase, one.truth()[i].phase) << i;
    EXPECT_EQ(showing.news[i].phase, one.truth()[i].phase) << i;
    EXPECT_EQ(made->segments[i].object, one.truth()[i].object) << i;
    EXPECT_NEAR(to_seconds(made->segments[i].begin - start), one.truth()[i].begin, 0.25) << i;
  }
}

TEST(Watcher, ObjectsInTheHandNeedNotBeSeen) {
  const Person one = person({talc_to(0.25, -0.05)});
  EXPECT_TRUE(std::any_of(one.truth().begin(), one.truth().end(),
                          [](const auto& each) { return each.phase == Phase::hold; }));
  Showing showing;
  showing.object = [&](const std::string& name, double t) {
    return name != "Talc" || t < 2 || t > one.duration() - 1.5;
  };
  const auto made = shown(one, showing);
  ASSERT_TRUE(made) << made.error().message();
  EXPECT_NEAR(made->steps.front().X_WO_after.translation().x(), 0.25, 0.005);
}

TEST(Watcher, SaysInOneLineWhatIsWrong) {
  const Person one = person({talc_to(0.25, -0.05)});
  const auto said = [&](Showing showing) {
    const auto made = shown(one, showing);
    return made ? std::string("understood") : made.error().message();
  };
  EXPECT_THAT(said({.object = [](auto&, double) { return false; }}),
              HasSubstr("no object was recognised"));
  EXPECT_THAT(said({.hand = [](double) { return false; }}), HasSubstr("no hand was seen"));
  EXPECT_THAT(said({.hand = [](double t) { return t < 2 || t > 3.5; }}),
              HasSubstr("the hand was not seen for 1."));
  EXPECT_THAT(said({.object = [](auto& name, double t) { return name != "Talc" || t < 2; }}),
              HasSubstr("Talc: is still in the hand, or out of sight"));
  EXPECT_THAT(said({.hand = [](double t) { return t < 4; }}),
              HasSubstr("the hand was not seen for"))
      << "it has left with the object";
  EXPECT_EQ(said({.hand = [&](double t) { return t < one.duration() - 0.7; }}), "understood");
  EXPECT_THAT(said({.until = 4}), HasSubstr("Talc: is still in the hand, or out of sight"));
  EXPECT_THAT(said({.until = 1}), HasSubstr("nothing was taken"));
}

TEST(Watcher, BeginsAndEndsOnce) {
  Watcher watcher{WatcherOptions{}};
  std::vector<TimedSegment> rest;
  const auto early = watcher.end(start, rest);
  ASSERT_FALSE(early);
  EXPECT_THAT(early.error().message(), HasSubstr("no demonstration has begun"));
  ASSERT_TRUE(watcher.begin("TEA", start));
  const auto twice = watcher.begin("COFFEE", start);
  ASSERT_FALSE(twice);
  EXPECT_THAT(twice.error().message(), HasSubstr("TEA: is being shown already"));
  EXPECT_FALSE(watcher.end(start, rest));
  EXPECT_FALSE(watcher.task());
}

TEST(Watcher, RefusesWhatCannotBe) {
  Watcher watcher{WatcherOptions{}};
  SeenHand hand{start, make_pose({0, 0, 0.2}), 1, {}};
  EXPECT_TRUE(watcher.see(hand, ""));
  EXPECT_FALSE(watcher.see(hand, "")) << "twice";
  hand.stamp += seconds(1);
  hand.X_WH.translation().x() = std::nan("");
  EXPECT_FALSE(watcher.see(hand, ""));
  hand.X_WH.translation().x() = 1000;
  EXPECT_FALSE(watcher.see(hand, ""));
  EXPECT_FALSE(watcher.see(SeenObject{start, "Talc", {}, Pose::Identity()})) << "no shape";
  SeenObject object{start, "0", catalogue().find("Talc")->shape, make_pose({0, 0, 11})};
  EXPECT_EQ(watcher.see(object).error().what, "pose of an object not usable") << "far away";
  object.X_WO = Pose::Identity();
  EXPECT_TRUE(watcher.see(object));
  EXPECT_EQ(watcher.see(object).error().what, "object older than the last");
  Expected<void> last;
  for (int n = 1; n < 100 && last; ++n) {
    object.name = std::to_string(n);
    last = watcher.see(object);
  }
  ASSERT_FALSE(last);
  EXPECT_EQ(last.error().what, "too many objects at once");
}

TEST(Person, TakesWhatIsThereAndFitsAHand) {
  const auto said = [](const model::Scene& there, const model::Catalogue& known,
                       const std::vector<Transfer>& transfers) {
    const auto made = Person::create(there, known, transfers, 1);
    return made ? std::string("taken") : made.error().message();
  };
  model::CatalogueObject barrel;
  barrel.name = "Barrel";
  barrel.shape = {model::ShapeKind::cylinder, {0.4, 0.4, 1}};
  model::Scene cellar;
  cellar.objects.push_back({"Barrel", make_pose({0, 0, 0.5})});
  EXPECT_EQ(said(scene(), catalogue(), {}), "person: shows nothing (name what is put where)");
  EXPECT_THAT(said(scene(), catalogue(), {{"Teapot", {0, 0, 0}, 0}}),
              HasSubstr("'Teapot' is not in the scene"));
  EXPECT_THAT(said(cellar, catalogue(), {talc_to(0, 0)}),
              HasSubstr("'Barrel' is not in the catalogue"));
  EXPECT_THAT(said(cellar, model::Catalogue({barrel}), {{"Barrel", {0, 0, 0.5}, 0}}),
              HasSubstr("'Barrel' is too large for the person's hand"));
}

TEST(Watcher, KeepsNoMoreThanTheLongestDemonstration) {
  Watcher watcher{WatcherOptions{.max_length = std::chrono::seconds(10)}};
  ASSERT_TRUE(watcher.begin("TEA", start));
  SeenHand hand{start + seconds(9), make_pose({0, 0, 0.2}), 1, {}};
  SeenObject talc{hand.stamp, "Talc", catalogue().find("Talc")->shape, make_pose({0, 0, 0.05})};
  EXPECT_TRUE(watcher.see(hand, ""));
  EXPECT_TRUE(watcher.see(talc));
  hand.stamp = talc.stamp = start + seconds(11);
  talc.X_WO.translation().x() = 0.5;
  EXPECT_THAT(watcher.see(hand, "").error().message(), HasSubstr("too long"));
  EXPECT_THAT(watcher.see(talc).error().message(), HasSubstr("too long"));
  hand.X_WH.translation().x() = 0.5;
  ASSERT_TRUE(watcher.object_at(hand)) << "where things are now is known all the same";
}

TEST(GraspJudge, AnswersByObjectAndApproachAndFavoursWhatFits) {
  const auto taxonomy = model::GraspTaxonomy::of_the_house().value();
  GraspJudge judge(taxonomy, nullptr);
  const Person one = person({talc_to(0.25, -0.05)});
  Random random(1);
  const SeenHand hand = hand_of(one, 0, random);
  const SeenObject talc{start, "Talc", catalogue().find("Talc")->shape, Pose::Identity()};
  const Distribution with = judge.see(hand, &talc), without = judge.see(hand, nullptr);
  EXPECT_NEAR(with.sum(), 1, 1e-9);
  EXPECT_NEAR(without.sum(), 1, 1e-9);
  EXPECT_GT(with.maxCoeff(), without.maxCoeff()) << "to know the object makes it surer";
  const std::vector<double> fit = taxonomy.fit_to_object(talc.shape);
  for (std::size_t k = 0; k < fit.size(); ++k)
    EXPECT_EQ(with[static_cast<Eigen::Index>(k)] == 0, fit[k] == 0) << judge.kinds()[k];
}

TEST(GraspJudge, WeighsWhatWasLearntOfObjectsAndWhatTheTaskPermits) {
  const auto takes = test::made_takes({});
  std::vector<Take> with_objects = takes;
  for (std::size_t i = 0; i < with_objects.size(); ++i) {
    const double radius = with_objects[i].label == "cup" ? 0.04 : 0.01;
    with_objects[i].object = {model::ShapeKind::cylinder, {radius, radius, 0.1}};
  }
  std::vector<const Take*> all;
  for (const Take& take : with_objects) all.push_back(&take);
  const auto trained = train_recognisers(all, {Method::posture}, {});
  ASSERT_TRUE(trained) << trained.error().message();
  const auto objects = ObjectLikelihood::learn(all, trained->front().classes());
  ASSERT_TRUE(objects);
  const auto taxonomy = model::GraspTaxonomy::of_the_house().value();
  GraspJudge judge(taxonomy, &trained->front(), &*objects);
  const auto cup = std::find(judge.kinds().begin(), judge.kinds().end(), "cup");
  ASSERT_NE(cup, judge.kinds().end());
  const auto k = cup - judge.kinds().begin();
  // A hand of which nothing is seen: what is known of the object decides.
  const auto said = [&](double radius) {
    judge.begin();
    const SeenHand hand{start, make_pose({0, 0, 0.2}), 1, {}};
    const SeenObject object{
        start, "it", {model::ShapeKind::cylinder, {radius, radius, 0.1}}, Pose::Identity()};
    return judge.see(hand, &object)[k];
  };
  EXPECT_GT(said(0.04), 0.9);
  EXPECT_LT(said(0.01), 0.1);
  Eigen::VectorXd forbidden =
      Eigen::VectorXd::Ones(static_cast<Eigen::Index>(judge.kinds().size()));
  forbidden[k] = 0;
  judge.expect(forbidden);
  EXPECT_EQ(said(0.04), 0) << "the task forbids it";
  judge.expect({});
  EXPECT_GT(said(0.04), 0.9) << "no task, no limit";
}

TEST(TaskPrior, IsHowOftenAKindWasShownAndNothingForWhatBlocksWhatIsNeeded) {
  const auto taxonomy = model::GraspTaxonomy::of_the_house().value();
  const std::vector<std::string> kinds{"large diameter", "power sphere", "tripod", "own kind"};
  const auto shown = [](const std::string& object, const std::string& grasp) {
    tasks::ShownStep step;
    step.object = object;
    step.grasp = grasp;
    return tasks::ShownTask{step};
  };
  const std::vector<tasks::ShownTask> before{shown("Cup", "tripod"), shown("Cup", "tripod"),
                                             shown("Talc", "large diameter"), shown("Cup", "")};
  const Eigen::VectorXd p = task_prior(kinds, taxonomy, {}, before, "Cup");
  EXPECT_NEAR(p.sum(), 1, 1e-12);
  EXPECT_NEAR(p[2], 3.0 / 6, 1e-12) << "twice, and once for all that may still come";
  EXPECT_NEAR(p[0], 1.0 / 6, 1e-12) << "shown for another object";
  const Eigen::VectorXd fill = task_prior(kinds, taxonomy, {model::ObjectPart::opening}, {}, "Cup");
  EXPECT_EQ(fill[1], 0) << "a sphere grasp lies on the opening";
  EXPECT_EQ(fill[0], fill[3]);
  EXPECT_GT(fill[0], 0);
}

/// Hands that a recogniser was trained on, one after the other, 10 ms each.
class Showman {
 public:
  explicit Showman(GraspJudge& judge) : judge_(judge) {}

  /// A grasp of this kind where the hand is.
  void grasp(const Take& take) {
    for (const HandSample& sample : take.samples) show(sample);
  }
  void go(double speed, double way, const HandSample& shape) {
    for (double left = way; left > 0; left -= speed / 100) {
      x_ += speed / 100;
      show(shape);
    }
  }
  const Distribution& said() const { return said_; }

 private:
  void show(const HandSample& sample) {
    SeenHand hand{now_ += std::chrono::milliseconds(10), make_pose({x_, 0, 0.1}), 1, {}};
    hand.X_WH.pretranslate(random_.normal3(0.001));
    hand.p_HF[0] = Eigen::Vector3d::Zero();
    for (std::size_t f = 1; f < hand.p_HF.size(); ++f) hand.p_HF[f] = sample.p_thumb_tip_W[f - 1];
    said_ = judge_.see(hand, nullptr);
  }

  GraspJudge& judge_;
  Time now_ = start;
  double x_ = 0;
  Random random_{5};
  Distribution said_;
};

TEST(GraspJudge, BeginsAnewWhenTheHandGoesToItsNextGrasp) {
  const auto takes = test::made_takes({});
  std::vector<const Take*> all;
  for (const Take& take : takes) all.push_back(&take);
  const auto trained = train_recognisers(all, {Method::posture}, {});
  ASSERT_TRUE(trained) << trained.error().message();
  const auto all_of = [&](const std::string& kind) {
    std::vector<const Take*> made;
    for (const Take& take : takes)
      if (take.label == kind) made.push_back(&take);
    return made;
  };
  const auto bottles = all_of("bottle"), knives = all_of("knife");
  const auto taxonomy = model::GraspTaxonomy::of_the_house().value();
  // Share of hands that are said to hold this after both grasps; by chance it is a third.
  const auto said_after = [&](double speed, const std::string& kind) {
    int said = 0;
    for (std::size_t i = 0; i < knives.size(); ++i) {
      GraspJudge judge(taxonomy, &trained->front());
      Showman showman(judge);
      showman.grasp(*bottles[i]);
      showman.go(speed, 0.4, knives[i]->samples.front());
      showman.grasp(*knives[i]);
      Eigen::Index best = 0;
      showman.said().maxCoeff(&best);
      said += judge.kinds()[static_cast<std::size_t>(best)] == kind;
    }
    return said / static_cast<double>(knives.size());
  };
  EXPECT_GT(said_after(0.5, "knife"), 0.5);
  EXPECT_GT(said_after(0.05, "bottle"), 0.5) << "one grasp, so the surest answer stays";
}

TEST(PalmSpeed, IsThatOfTheHandAndNotOfTheNoise) {
  Random random(3);
  const auto speed_at = [&](double v, double rate) {
    PalmSpeed speed;
    double last = 0, sum = 0;
    for (int n = 0; n < rate; ++n) {
      const Eigen::Vector3d p(v * n / rate, 0, 0);
      last = speed.add(start + seconds(n / rate), p + random.normal3(0.0015));
      if (2 * n >= rate) sum += last;
    }
    return sum / (rate / 2);
  };
  for (const double rate : {30, 100}) {
    EXPECT_LT(speed_at(0, rate), 0.1);
    EXPECT_NEAR(speed_at(0.4, rate), 0.4, 0.05);
  }
}

}  // namespace
}  // namespace prehend::demonstration
