// Model files: what was saved comes back; what is damaged or foreign is refused by name.
#include <gmock/gmock.h>
#include <google/protobuf/stubs/logging.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

#include "common/proto/mapping_model.pb.h"
#include "common/proto/sealed_file.hpp"
#include "services/mapping/files/mapping_model_file.hpp"
#include "tests/unit/mapping/fixtures.hpp"

namespace prehend::mapping {
namespace {

class ModelFile : public testing::Test {
 protected:
  void SetUp() override {
    file_ = std::filesystem::path(testing::TempDir()) / "prehend_model_file_test.mapping";
    ASSERT_TRUE(save_mapping_model(file_, random_model(1), barrett()));
    std::ifstream in(file_, std::ios::binary);
    std::stringstream all;
    all << in.rdbuf();
    bytes_ = all.str();
  }
  void TearDown() override { std::filesystem::remove(file_); }
  void write(const std::string& bytes) {
    std::ofstream out(file_, std::ios::binary | std::ios::trunc);
    out << bytes;
  }
  /// Saves the message in its seal after a change, as a foreign program might.
  void rewrite(const std::function<void(messages::MappingModel&)>& change) {
    messages::MappingModel message;
    ASSERT_TRUE(message.ParseFromString(*proto::unseal(bytes_, "mapping-model")));
    change(message);
    ASSERT_TRUE(proto::write_sealed(file_, "mapping-model", message.SerializeAsString()));
  }
  std::string refusal() {
    const auto loaded = load_mapping_model(file_, barrett());
    return loaded ? "loaded" : loaded.error().message();
  }

  std::filesystem::path file_;
  std::string bytes_;
};

// What cascade training grows, and every way to scale.
TEST_F(ModelFile, CarriesShortcutsAndScalings) {
  for (const auto kind : {learning::ScalingKind::whole_matrix, learning::ScalingKind::as_printed}) {
    Random random(5);
    const auto dofs = static_cast<Eigen::Index>(barrett().dofs().size());
    learning::Layer grown(1, feature_count + 1), last(dofs, feature_count + 2);
    for (learning::Layer* layer : {&grown, &last})
      for (double& weight : layer->reshaped()) weight = random.normal();
    MappingNetwork network = random_network(model::ShapeKind::unknown, 1);
    network.network = *learning::Network::create({grown, last}, learning::Wiring::shortcut);
    network.input = *learning::Scaling::create(Eigen::VectorXd::Constant(feature_count, -0.1),
                                               Eigen::VectorXd::Constant(feature_count, 0.3), kind);
    const auto saved = MappingModel::create(barrett(), plain_traits(barrett()), {network});
    ASSERT_TRUE(saved) << saved.error().message();
    ASSERT_TRUE(save_mapping_model(file_, *saved, barrett()));
    const auto loaded = load_mapping_model(file_, barrett());
    ASSERT_TRUE(loaded) << loaded.error().message();
    EXPECT_EQ(loaded->networks()[0].network.wiring(), learning::Wiring::shortcut);
    EXPECT_EQ(loaded->networks()[0].input.kind(), kind);
    const Features f = Features::Constant(0.07);
    EXPECT_EQ(loaded->direct(f).dof, saved->direct(f).dof);
  }
  rewrite([](messages::MappingModel& message) {
    message.mutable_networks(0)->mutable_input()->set_kind("by feeling");
  });
  EXPECT_THAT(refusal(), testing::HasSubstr("unknown scaling «by feeling»"));
}

TEST_F(ModelFile, ComesBackBitForBit) {
  const auto loaded = load_mapping_model(file_, barrett());
  ASSERT_TRUE(loaded) << loaded.error().message();
  const MappingModel saved = random_model(1);
  Random random(3);
  for (int i = 0; i < 50; ++i) {
    Features f;
    for (double& value : f) value = random.uniform(-0.3, 0.3);
    EXPECT_EQ(loaded->direct(f).dof, saved.direct(f).dof);
    const model::Shape box{model::ShapeKind::box, {0.04, 0.12, 0.2}};
    EXPECT_EQ(loaded->intelligent(f, box, Pose::Identity())->dof,
              saved.intelligent(f, box, Pose::Identity())->dof);
  }
  EXPECT_FALSE(loaded->intelligent(Features::Zero(), {model::ShapeKind::unknown, {1, 1, 1}},
                                   Pose::Identity()));
}

TEST_F(ModelFile, CarriesWhereTheHandStands) {
  ModelTraits traits = plain_traits(barrett());
  traits.places = {{model::ShapeKind::box, {0.04, 0.1, 0.2, 1}, {0, -0.012, 0.005}}};
  const auto saved =
      MappingModel::create(barrett(), traits, {random_network(model::ShapeKind::unknown, 1)});
  ASSERT_TRUE(saved) << saved.error().message();
  ASSERT_TRUE(save_mapping_model(file_, *saved, barrett()));
  const auto loaded = load_mapping_model(file_, barrett());
  ASSERT_TRUE(loaded) << loaded.error().message();
  ASSERT_EQ(loaded->traits().places.size(), 1u);
  EXPECT_EQ(loaded->traits().places[0].shape, model::ShapeKind::box);
  EXPECT_EQ(loaded->traits().places[0].seen, traits.places[0].seen);
  EXPECT_EQ(loaded->traits().places[0].p_GR, traits.places[0].p_GR);
  rewrite([](messages::MappingModel& message) { message.add_places()->set_shape("box"); });
  EXPECT_THAT(refusal(), testing::HasSubstr("a place without shape, size or coordinates"));
  rewrite([](messages::MappingModel& message) {
    messages::LearntPlace& place = *message.add_places();
    place.set_shape("box");
    for (int i = 0; i < 4; ++i) place.add_seen(0.1);
    for (int i = 0; i < 3; ++i) place.add_place(1);
  });
  EXPECT_THAT(refusal(), testing::HasSubstr("nowhere near"));
}

TEST_F(ModelFile, NoMutationLoads) {
  Random random(5);
  for (int trial = 0; trial < 4000; ++trial) {
    std::string mutated = bytes_;
    if (trial % 4 == 3)
      mutated.resize(random.index(mutated.size()));
    else
      for (int flip = 0; flip <= trial % 4; ++flip)
        mutated[random.index(mutated.size())] ^= static_cast<char>(1 << random.index(8));
    if (mutated == bytes_) continue;
    write(mutated);
    ASSERT_FALSE(load_mapping_model(file_, barrett())) << "trial " << trial;
  }
}

// Well sealed, but the content is random: the parser and the checks behind the seal must hold
// alone.
TEST_F(ModelFile, MutationsBehindTheSealNeverCrash) {
  Random random(6);
  const std::string content = *proto::unseal(bytes_, "mapping-model");
  google::protobuf::SetLogHandler(nullptr);  // it would report every broken name
  int refused = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    std::string mutated = content;
    for (int flip = 0; flip < 3; ++flip)
      mutated[random.index(mutated.size())] ^= static_cast<char>(1 << random.index(8));
    ASSERT_TRUE(proto::write_sealed(file_, "mapping-model", mutated));
    const auto loaded = load_mapping_model(file_, barrett());
    if (!loaded) {
      ++refused;
      continue;
    }
    EXPECT_TRUE(loaded->direct(Features::Zero()).dof.allFinite());
  }
  EXPECT_GT(refused, 0);
}

TEST_F(ModelFile, OfAnotherHandIsRefusedByName) {
  rewrite([](auto& message) { message.set_hand("robonaut"); });
  EXPECT_THAT(refusal(), testing::HasSubstr("trained for the hand «robonaut», not for «barrett»"));
  rewrite([](auto& message) { message.mutable_dofs(1)->set_upper(1); });
  EXPECT_THAT(refusal(), testing::HasSubstr("another version of the hand «barrett»"));
}

TEST_F(ModelFile, WithPartsMissingIsRefused) {
  rewrite([](auto& message) { message.mutable_networks()->DeleteSubrange(0, 1); });
  EXPECT_THAT(refusal(), testing::HasSubstr("no direct network"));
  rewrite([](auto& message) { *message.add_networks() = message.networks(1); });
  EXPECT_THAT(refusal(), testing::HasSubstr("two networks"));
  rewrite([](auto& message) { message.mutable_networks(1)->set_shape("teapot"); });
  EXPECT_THAT(refusal(), testing::HasSubstr("unknown shape «teapot»"));
  rewrite([](auto& message) { message.mutable_networks(0)->mutable_layers()->RemoveLast(); });
  EXPECT_THAT(refusal(), testing::HasSubstr("wrong number of outputs"));
  rewrite([](auto& message) {
    message.mutable_networks(0)->mutable_layers(0)->set_weights(3, std::nan(""));
  });
  EXPECT_THAT(refusal(), testing::HasSubstr("not finite"));
  rewrite([](auto& message) { message.mutable_networks(0)->mutable_layers(0)->set_outputs(0); });
  EXPECT_THAT(refusal(), testing::HasSubstr("do not fill"));
  rewrite([](auto& message) { message.set_size_input("weight"); });
  EXPECT_THAT(refusal(), testing::HasSubstr("unknown size input «weight»"));
  rewrite([](auto& message) { message.set_size_input("dimensions"); });
  EXPECT_THAT(refusal(), testing::HasSubstr("wrong number of inputs"));
  rewrite([](auto& message) { message.clear_lower(); });
  EXPECT_THAT(refusal(), testing::HasSubstr("wrong number of limits"));
  rewrite([](auto& message) { message.set_upper(2, 9); });
  EXPECT_THAT(refusal(), testing::HasSubstr("limits that are not the hand's"));
  rewrite([](auto& message) { message.add_precision(1); });
  EXPECT_THAT(refusal(), testing::HasSubstr("wrong number of weights for precision grasps"));
  rewrite([](auto& message) {
    message.clear_precision();
    for (int n = 0; n <= feature_count; ++n) message.add_precision(std::nan(""));
  });
  EXPECT_THAT(refusal(), testing::HasSubstr("weights for precision grasps are not finite"));
  rewrite([](auto& message) { *message.mutable_closing() = message.networks(0); });
  EXPECT_THAT(refusal(), testing::HasSubstr("closing: wrong number of inputs or outputs"));
}

TEST_F(ModelFile, OfAnotherKindOrAbsentIsRefused) {
  ASSERT_TRUE(proto::write_sealed(file_, "object-model", "something"));
  EXPECT_NE(refusal(), "loaded");
  std::filesystem::remove(file_);
  EXPECT_NE(refusal(), "loaded");
}

TEST(MappingModel, SaysWhenItIsAskedOutsideOfWhatItKnows) {
  const MappingModel model = random_model(1);
  Features f = Features::Zero();
  EXPECT_FALSE(model.direct(f).extrapolating);
  f[4] = 0.25;
  EXPECT_TRUE(model.direct(f).extrapolating);
  // Beyond a tenth of the range further out the answer stays what it is there.
  f[4] = 0.25;
  const Eigen::VectorXd far = model.direct(f).dof;
  f[4] = 25;
  EXPECT_EQ(model.direct(f).dof, far);
  // The nearest trained size answers for one outside.
  f.setZero();
  const auto of_radius = [&](double r) {
    return *model.intelligent(f, {model::ShapeKind::cylinder, {r, r, 0.1}}, Pose::Identity());
  };
  EXPECT_FALSE(of_radius(0.08).extrapolating);
  EXPECT_TRUE(of_radius(0.09).extrapolating);
  EXPECT_EQ(of_radius(0.09).dof, of_radius(0.08).dof);
}

TEST(MappingModel, AnswersForShapesThatAreLikeThoseItKnows) {
  const MappingModel model = random_model(1);
  const auto dof = [&](const model::Shape& shape) {
    return model.intelligent(Features::Zero(), shape, Pose::Identity())->dof;
  };
  const model::Shape cup{model::ShapeKind::cone, {0.03, 0.05, 0.1}};
  EXPECT_EQ(dof(cup), dof({model::ShapeKind::cylinder, {0.04, 0.04, 0.1}}));
  const model::Shape ball{model::ShapeKind::sphere, Eigen::Vector3d::Constant(0.04)};
  EXPECT_EQ(dof(ball), dof({model::ShapeKind::cylinder, {0.04, 0.04, 0.08}}));
  EXPECT_FALSE(model.known_as({model::ShapeKind::unknown, {0.1, 0.1, 0.1}}));
}

}  // namespace
}  // namespace prehend::mapping
