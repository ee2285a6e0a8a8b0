#include "services/demonstration/core/recognition/recogniser.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "services/demonstration/files/recogniser_file.hpp"
#include "services/demonstration/tools/evaluation/trial.hpp"
#include "services/demonstration/tools/training/trainer.hpp"
#include "tests/support/takes/made_takes.hpp"

namespace prehend::demonstration {
namespace {

const std::vector<Take>& shown() {
  static const auto takes = test::made_takes({});
  return takes;
}

std::vector<const Take*> pointers(const std::vector<Take>& takes) {
  std::vector<const Take*> made;
  for (const Take& take : takes) made.push_back(&take);
  return made;
}

const std::vector<Recogniser>& trained() {
  static const auto made =
      train_recognisers(pointers(shown()), {methods.begin(), methods.end()}, {});
  return *made;
}

// People whom nobody trained on, of kinds that differ in shape, direction and speed alike: every
// method tells them apart.
TEST(Recogniser, EveryMethodKnowsNewPeople) {
  const auto others = test::made_takes({.people = 4, .seed = 99});
  ASSERT_EQ(trained().size(), methods.size());
  for (const Recogniser& recogniser : trained()) {
    int right = 0;
    for (const Take& take : others) {
      const Distribution p = recogniser.recognise(take.samples);
      EXPECT_NEAR(p.sum(), 1, 1e-12);
      Eigen::Index best = 0;
      p.maxCoeff(&best);
      right += recogniser.classes()[static_cast<std::size_t>(best)] == take.label;
    }
    EXPECT_GE(right, static_cast<int>(0.95 * static_cast<double>(others.size())))
        << to_string(recogniser.method());
  }
}

TEST(Recogniser, EachSampleIsAnsweredAndTheAnswerOnlyGetsSurer) {
  for (const Recogniser& recogniser : trained())
    for (const Take& take : shown()) {
      RecogniserStream stream(recogniser);
      double sure = 1.0 / static_cast<double>(recogniser.classes().size()) - 1e-12;
      for (const HandSample& sample : take.samples) {
        const Distribution& p = stream.add(sample);
        EXPECT_NEAR(p.sum(), 1, 1e-12);
        EXPECT_GE(p.maxCoeff(), sure);
        sure = p.maxCoeff();
      }
    }
}

TEST(Recogniser, PostureKnowsNothingOfDirectionAndSpeed) {
  for (const Recogniser& recogniser : trained()) {
    if (recogniser.method() != Method::posture) continue;
    Take take = shown().front();
    const Distribution before = recogniser.recognise(take.samples);
    for (HandSample& sample : take.samples) {
      for (auto& tip : sample.p_thumb_tip_W) tip = Eigen::Vector3d(-tip.y(), tip.x(), tip.z());
      sample.hand_speed = sample.wrist_speed = 5;
      sample.t *= 3;
    }
    EXPECT_TRUE(before.isApprox(recogniser.recognise(take.samples), 1e-9));
  }
}

TEST(Recogniser, UnknownNumbersAndNoSamplesGiveAnAnswerAllTheSame) {
  for (const Recogniser& recogniser : trained()) {
    EXPECT_NEAR(recogniser.recognise({}).maxCoeff(), 1.0 / 3, 1e-12);
    const Distribution of_nothing = recogniser.recognise({HandSample{}});
    EXPECT_TRUE(of_nothing.allFinite()) << to_string(recogniser.method());
    Take take = shown().front();
    for (HandSample& sample : take.samples) {
      sample.hand_speed = sample.wrist_speed = unknown_number;
      sample.p_thumb_tip_W[3].setConstant(unknown_number);
    }
    EXPECT_NEAR(recogniser.recognise(take.samples).sum(), 1, 1e-9);
  }
}

TEST(Recogniser, ComesBackFromItsFile) {
  const auto file =
      std::filesystem::path(testing::TempDir()) / ("grasps" + std::to_string(getpid()) + ".model");
  std::vector<TaskRecogniser> all;
  for (const Recogniser& recogniser : trained()) all.push_back({"1", recogniser, 6, 72});
  std::vector<Take> with_objects = shown();
  for (Take& take : with_objects)
    take.object = {model::ShapeKind::cylinder, {0.02, 0.02, take.label == "cup" ? 0.1 : 0.2}};
  all.front().objects =
      ObjectLikelihood::learn(pointers(with_objects), trained().front().classes()).value();
  ASSERT_TRUE(save_recognisers(file, all));
  const auto back = load_recognisers(file);
  std::filesystem::remove(file);
  ASSERT_TRUE(back) << back.error().message();
  ASSERT_EQ(back->size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ((*back)[i].task, "1");
    EXPECT_EQ((*back)[i].people, 6U);
    EXPECT_EQ((*back)[i].recogniser.classes(), all[i].recogniser.classes());
    for (const Take& take : shown())
      EXPECT_EQ((*back)[i].recogniser.recognise(take.samples),
                all[i].recogniser.recognise(take.samples));
  }
  ASSERT_TRUE(back->front().objects);
  EXPECT_FALSE(back->back().objects) << "nobody measured them";
  const model::Shape cup{model::ShapeKind::cylinder, {0.021, 0.021, 0.09}};
  EXPECT_EQ(back->front().objects->of(cup), all.front().objects->of(cup));
  EXPECT_FALSE(load_recognisers(file));
}

TEST(Recogniser, TheSameTakesGiveTheSameRecogniser) {
  const auto again = train_recognisers(pointers(shown()), {Method::hybrid}, {});
  ASSERT_TRUE(again);
  for (const Take& take : shown())
    EXPECT_EQ(again->front().recognise(take.samples), trained().front().recognise(take.samples));
}

TEST(Recogniser, TrainingSaysWhatItLacks) {
  const auto one_person = test::made_takes({.people = 1});
  const auto alone = train_recognisers(pointers(one_person), {Method::hmm}, {});
  ASSERT_FALSE(alone);
  EXPECT_NE(alone.error().what.find("people"), std::string::npos);
  const auto one_kind = test::made_takes({.classes = {"cup"}});
  EXPECT_FALSE(train_recognisers(pointers(one_kind), {Method::hmm}, {}));
}

// Nothing of the person who is judged has been seen in training: a kind that only this person
// shows can then not be named.
TEST(Recogniser, PeopleAreJudgedByWhatOthersShowed) {
  auto takes = shown();
  for (Take& take : takes)
    if (take.user == "0" && take.label == "cup") take.label = "own";
  const auto results = judge(takes, nullptr, {.folds = 2, .epochs = 30}, 1, [](auto, auto) {});
  ASSERT_EQ(results.size(), 1U);
  ASSERT_FALSE(results[0].trouble) << results[0].trouble->message();
  for (const auto& [method, judged] : results[0].methods) {
    EXPECT_EQ(judged.size(), takes.size()) << "no take is left out";
    for (const Judged& one : judged)
      if (results[0].classes[one.truth] == "own") {
        EXPECT_FALSE(one.right());
      }
  }
}

}  // namespace
}  // namespace prehend::demonstration
