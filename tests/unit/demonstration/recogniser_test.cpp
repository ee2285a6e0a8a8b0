#include "services/demonstration/core/recognition/recogniser.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <functional>

#include "common/proto/grasp_recogniser.pb.h"
#include "common/proto/sealed_file.hpp"
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

using Message = messages::GraspRecogniser;
using Spoil = std::function<void(Message&)>;

/// What is said of the file of a recogniser that was spoilt and sealed again.
std::string refusal(Method method, const Spoil& spoil) {
  const auto file =
      std::filesystem::path(testing::TempDir()) / ("odd" + std::to_string(getpid()) + ".model");
  for (const Recogniser& recogniser : trained())
    if (recogniser.method() == method) {
      EXPECT_TRUE(save_recognisers(file, {{"1", recogniser, 6, 72}}));
    }
  messages::GraspRecogniserSet set;
  EXPECT_TRUE(set.ParseFromString(proto::read_sealed(file, "grasp-recogniser").value()));
  spoil(*set.mutable_recognisers(0));
  EXPECT_TRUE(proto::write_sealed(file, "grasp-recogniser", set.SerializeAsString()));
  const auto made = load_recognisers(file);
  std::filesystem::remove(file);
  return made ? "taken" : made.error().what;
}

TEST(Recogniser, AFileThatContradictsItselfIsRefusedByName) {
  const auto classifier = [](Message& m) { return m.mutable_classifiers(0); };
  const auto other_inputs = [&](Message& m) { classifier(m)->set_inputs("motion"); };
  const std::vector<std::tuple<Method, Spoil, const char*>> spoilt{
      {Method::posture, [](Message& m) { m.clear_classes(); }, "needs at least two kinds"},
      {Method::posture, [](Message& m) { m.set_classes(1, m.classes(0)); }, "is there twice"},
      {Method::posture, [](Message& m) { m.clear_classifiers(); }, "has no classifier"},
      {Method::posture, [&](Message& m) { classifier(m)->set_weight(std::nan("")); },
       "a classifier's weight is no number"},
      {Method::posture, [](Message& m) { m.set_temperature(0); }, "temperature is not above 0"},
      {Method::posture, [](Message& m) { m.set_method("guess"); }, "unknown method «guess»"},
      {Method::posture, [&](Message& m) { classifier(m)->set_inputs("taste"); },
       "unknown inputs «taste»"},
      {Method::posture, [](Message& m) { m.add_classes("one more"); },
       "a network does not fit its inputs or classes"},
      {Method::posture, [&](Message& m) { classifier(m)->mutable_scale()->add_mean(0); },
       "as many means as deviations"},
      {Method::posture,
       [&](Message& m) {
         auto& turn = *classifier(m)->mutable_scale()->mutable_turn();
         turn.set_rows(0);
         turn.add_values(1);
       },
       "numbers do not fill a matrix"},
      {Method::posture, other_inputs, "a classifier's scale does not fit its inputs"},
      {Method::posture, [&](Message& m) { classifier(m)->clear_networks(); },
       "networks and hidden Markov models, or neither"},
      {Method::posture, [](Message& m) { m.mutable_objects()->add_otherwise(1); },
       "what objects say is of other classes"},
      {Method::posture,
       [](Message& m) {
         for (int n = 0; n < m.classes_size(); ++n) m.mutable_objects()->add_otherwise(1);
         m.mutable_objects()->add_sizes()->set_shape("teapot");
       },
       "unknown shape «teapot»"},
      {Method::hmm, other_inputs, "a classifier's scale does not fit its inputs"},
      {Method::hmm,
       [&](Message& m) { classifier(m)->mutable_hidden_markov_models()->RemoveLast(); },
       "not as many hidden Markov models as classes"},
      {Method::hmm,
       [&](Message& m) {
         auto& model = *classifier(m)->mutable_hidden_markov_models(0);
         for (messages::Numbers* each : {model.mutable_means(), model.mutable_variances()}) {
           each->set_rows(1);
           each->mutable_values()->Truncate(model.initial_size());
         }
       },
       "a hidden Markov model does not fit its inputs"}};
  for (const auto& [method, spoil, words] : spoilt)
    EXPECT_THAT(refusal(method, spoil), testing::HasSubstr(words)) << to_string(method);
}

TEST(Recogniser, NeedsNetworksWhereItHasNoModels) {
  for (const Recogniser& recogniser : trained()) {
    if (recogniser.method() != Method::posture) continue;
    Part part = recogniser.parts().front();
    std::get<NetworkClassifier>(part.classifier).networks.clear();
    EXPECT_EQ(Recogniser::create(Method::posture, recogniser.classes(), {part}, 1).error().what,
              "a classifier has no network");
  }
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
