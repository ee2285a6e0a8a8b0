// Where consent comes from: a button of the glove, a key that is held while somebody watches or
// teaches; and a stop by any key.
#include "services/glove/devices/datagrams.hpp"
#include "services/glove/devices/landmark_line.hpp"
#include "tests/integration/safety_rig.hpp"
#include "tests/integration/terminal.hpp"

namespace prehend::integration {
namespace {

class ConsentSources : public SafetyRig {
 protected:
  void start_hand_that_asks(Strings sets = {}) {
    sets.push_back("safety.deadman=true");
    simulation_.emplace(start("simulation", sets));
    ASSERT_TRUE(wait(30, [&] { return heard_ > 0 && gate_.deadman(); }));
    EXPECT_FALSE(gate_.consent());
  }
  /// Presses the key as a keyboard repeats it, until there is consent; then not until there is
  /// none.
  void expect_consent_by_space(Terminal& terminal) {
    EXPECT_TRUE(wait(30, [&] {
      terminal.press(" ");
      return gate_.consent();
    })) << terminal.shown();
    EXPECT_TRUE(wait(20, [&] { return !gate_.consent(); })) << "the key was let go";
  }
};

TEST_F(ConsentSources, TheButtonOfTheGlove) {
  start_hand_that_asks({"safety.button=2"});
  glove_.emplace(start("glove", {"glove.device=landmarks", "glove.port=" + address()}));
  auto sender = glove::DatagramSender::create(address());
  ASSERT_TRUE(sender);
  const glove::Landmarks points = glove::landmarks_of(
      model::HumanHand(1), model::HumanHand::posture({0.5, 0.5, 0.5, 0.5, 0.5}));
  int sent = 0;
  const auto show = [&](const std::vector<std::uint8_t>& held) {
    glove::LandmarkLine line{.in_room = true, .points = points, .held = held};
    for (auto& point : line.points) point += Eigen::Vector3d(0.1 + 1e-5 * ++sent, -0.4, 0.2);
    sender->write(glove::to_line(line) + "\n");
    std::this_thread::sleep_for(std::chrono::milliseconds(15));
  };
  auto buttons = reader(dds::glove_button);
  std::optional<v1::GloveButton> button;
  EXPECT_TRUE(wait(30, [&] {
    show({1, 2});
    for (auto& sample : buttons.take())
      if (!sample.info.gone) button = sample.data;
    return button && gate_.consent();  // the gate may hear it first
  }));
  ASSERT_TRUE(button);
  EXPECT_EQ(button->glove().to_string(), "glove");
  EXPECT_EQ(button->held(), (std::vector<std::uint8_t>{1, 2}));
  // Another one is none.
  EXPECT_TRUE(wait(20, [&] {
    show({1});
    return !gate_.consent();
  }));
  EXPECT_TRUE(wait(30, [&] {
    show({2});
    return gate_.consent();
  }));
  // A glove that falls silent holds nothing.
  EXPECT_TRUE(wait(20, [&] { return !gate_.consent(); }));
}

// One that pretends to be the glove, and is no service: it is not known by its name.
TEST_F(ConsentSources, AButtonOfNobodyIsNone) {
  start_hand_that_asks({"safety.button=1"});
  auto buttons = writer(dds::glove_button);
  meet(buttons);
  for (int i = 0; i < 50; ++i) {
    v1::GloveButton button;
    button.glove("glove");
    button.stamp_ns(now_ns());
    button.held({1});
    ASSERT_TRUE(buttons.write(button));
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    listen();
    EXPECT_FALSE(gate_.consent());
  }
}

TEST_F(ConsentSources, TheSpaceBarWhileTheGloveIsWatched) {
  start_hand_that_asks();
  Terminal terminal(program("prehend-glove-tool"), with_lab({"watch", "--consent"}));
  expect_consent_by_space(terminal);
  terminal.press("q");
  EXPECT_NE(terminal.end(), -1);
}

TEST_F(ConsentSources, TheSpaceBarWhileSomebodyTeaches) {
  start_hand_that_asks();
  Terminal terminal(program("prehend-teach"), with_lab({"--consent", "--hand", "barrett", "-o",
                                                        (folder_ / "taught").string()}));
  EXPECT_TRUE(terminal.shows("hold the space bar"));
  expect_consent_by_space(terminal);
  terminal.press("q");
  EXPECT_EQ(terminal.end(), 1);
}

TEST_F(ConsentSources, AnyKeyStopsAtOnce) {
  start_hand();
  EXPECT_EQ(run("prehend", with_lab({"stop", "--key"}), 30).exit_code, 2) << "no terminal";
  Terminal terminal(program("prehend"), with_lab({"stop", "--key", "--reason", "a key"}));
  EXPECT_TRUE(terminal.shows("any key stops"));
  EXPECT_FALSE(wait(1, [&] { return gate_.stopped(); })) << "nobody has pressed one";
  terminal.press("x");
  EXPECT_TRUE(wait(20, [&] { return gate_.stopped(); }));
  EXPECT_EQ(gate_.reason().to_string(), "a key");
  EXPECT_EQ(terminal.end(), 0);
}

}  // namespace
}  // namespace prehend::integration
