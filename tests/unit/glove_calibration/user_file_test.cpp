// What is saved is what is loaded, to the digits of the file (0.1 of a permille of the scale, 0.01
// mm of the bones); anything else is one clear error.
#include "services/glove/files/user_file.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "common/base/random.hpp"

namespace prehend::glove {
namespace {

namespace fs = std::filesystem;

class UserFile : public testing::Test {
 protected:
  UserFile()
      : folder_(fs::temp_directory_path() / ("prehend-user-" + std::to_string(::getpid()))) {}
  ~UserFile() override { fs::remove_all(folder_); }

  static UserCalibration somebody() {
    UserCalibration user{
        .user = "anna \"q\" \\", .scale = 0.93, .scale_sd = 0.02, .residual = 0.003};
    const model::HumanHand hand(0.93, {1.02, 0.97, 1, 1.05, 0.95});
    for (std::size_t f = 0; f < user.bones.size(); ++f) {
      user.bones[f] = hand.bones(static_cast<model::Finger>(f));
      user.range[f] = {0.06, 0.15};
    }
    return user;
  }
  fs::path write(const std::string& text) {
    fs::create_directories(folder_);
    std::ofstream(folder_ / "x.toml") << text;
    return folder_ / "x.toml";
  }

  fs::path folder_;
};

TEST_F(UserFile, IsReadAsWritten) {
  UserCalibration user = somebody();
  user.gain = {0.0148, 0.013};
  user.offset = {-0.8, -3.6};
  const fs::path file = folder_ / "users" / "anna.toml";
  ASSERT_TRUE(save(file, user));
  const auto loaded = load_user(file);
  ASSERT_TRUE(loaded) << loaded.error().message();
  EXPECT_EQ(loaded->user, user.user);
  EXPECT_NEAR(loaded->scale, user.scale, 1e-4);
  EXPECT_EQ(loaded->gain, user.gain);
  EXPECT_EQ(loaded->offset, user.offset);
  const auto posture = model::HumanHand::posture({0.3, 0.3, 0.3, 0.3, 0.3});
  const auto wanted = model::HumanHand(0.93, {1.02, 0.97, 1, 1.05, 0.95}).fingertip_poses(posture);
  const auto got = loaded->hand().fingertip_poses(posture);
  for (std::size_t f = 0; f < got.size(); ++f)
    EXPECT_LT((got[f].translation() - wanted[f].translation()).norm(), 1e-4);
}

TEST_F(UserFile, SaysWhereItCannotBeWritten) {
  ASSERT_TRUE(save(folder_ / "good.toml", somebody()));
  const auto saved = save(folder_ / "good.toml" / "in_a_file.toml", somebody());
  ASSERT_FALSE(saved);
  EXPECT_TRUE(saved.error().message().ends_with(
      "in_a_file.toml: the file cannot be written (choose another with --out)"));
}

TEST_F(UserFile, RefusesWhatIsNoHand) {
  EXPECT_FALSE(load_user(folder_ / "nobody.toml"));
  ASSERT_TRUE(save(folder_ / "good.toml", somebody()));
  std::ifstream stream(folder_ / "good.toml");
  const std::string good{std::istreambuf_iterator<char>(stream), {}};
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    return load_user(write(text)).has_value();
  };
  EXPECT_TRUE(with("0.9300", "0.9300"));
  EXPECT_FALSE(with("0.9300", "9.3"));
  EXPECT_FALSE(with("0.9300", "nan"));
  EXPECT_FALSE(with("hand_scale =", "scale ="));
  EXPECT_FALSE(with("user =", "someone ="));
  EXPECT_FALSE(with("bones = [", "bones = [0.01, "));
  EXPECT_FALSE(with("bones = [", "bones = [inf, "));
  EXPECT_FALSE(with("[finger.little]", "[finger.toe]"));
  EXPECT_FALSE(with("[finger.little]", "[joint_glove]\ngain = [1.0]\n[finger.little]"));
  EXPECT_FALSE(with("user", "\x01"));
}

// Flipped, dropped and doubled bytes give an error or a hand.
TEST_F(UserFile, SurvivesDamage) {
  ASSERT_TRUE(save(folder_ / "good.toml", somebody()));
  std::ifstream stream(folder_ / "good.toml");
  const std::string good{std::istreambuf_iterator<char>(stream), {}};
  Random random(3);
  for (int n = 0; n < 400; ++n) {
    std::string text = good;
    for (std::size_t changes = 1 + random.index(6); changes > 0; --changes) {
      const std::size_t at = random.index(text.size());
      if (random.uniform() < 0.5)
        text[at] = static_cast<char>(random.bits());
      else
        text.erase(at, 1 + random.index(10));
    }
    if (const auto user = load_user(write(text))) {
      EXPECT_TRUE(user->scale >= 0.7 && user->scale <= 1.4);
      EXPECT_TRUE(std::isfinite(
          user->hand().fingertip_poses(model::HumanPosture::Zero())[0].translation().x()));
    }
  }
}

}  // namespace
}  // namespace prehend::glove
