// The lines of hand tracking programs: what is documented is read, anything else has a reason.
#include "services/glove/devices/landmark_line.hpp"

#include <gtest/gtest.h>

#include "common/base/random.hpp"
#include "services/glove/core/plausible_hand.hpp"

namespace prehend::glove {
namespace {

LandmarkLine some_line() {
  LandmarkLine line{.stamp = 1732200000.125, .left = false, .in_room = true, .points = {}};
  const auto points =
      landmarks_of(model::HumanHand(1), model::HumanHand::posture({0.2, 0.3, 0.4, 0.5, 0.6}));
  for (std::size_t i = 0; i < points.size(); ++i)
    line.points[i] = points[i] + Eigen::Vector3d(0.1, -0.4, 0.3);
  return line;
}

std::string_view refusal(const std::string& text) {
  const auto line = parse_landmarks(text);
  return line ? "" : line.error();
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

TEST(LandmarkLine, ReadsBothOrders) {
  const LandmarkLine truth = some_line();
  for (const bool webxr : {false, true}) {
    const auto line = parse_landmarks(to_line(truth, webxr));
    ASSERT_TRUE(line) << line.error();
    EXPECT_EQ(line->points, truth.points) << "to the last bit: numbers are written in full";
    EXPECT_EQ(line->stamp, truth.stamp);
    EXPECT_TRUE(line->in_room);
    EXPECT_FALSE(line->left);
  }
}

// As the documentation has it, without the optional stamp.
TEST(LandmarkLine, ReadsAWrittenLine) {
  std::string points;
  for (int i = 0; i < 21; ++i) points += (i ? ", [" : "[") + std::to_string(0.01 * i) + ", 0, 1]";
  const auto line = parse_landmarks(
      R"({"version": 1, "hand": "left", "origin": "hand", "points_m": [)" + points + "]}\r");
  ASSERT_TRUE(line) << line.error();
  EXPECT_TRUE(line->left);
  EXPECT_FALSE(line->in_room);
  EXPECT_FALSE(line->stamp);
  EXPECT_NEAR(line->points[20].x(), 0.2, 1e-9);
}

std::string controller_line(const std::string& hand, const std::string& controller) {
  return R"({"version": 1, "hand": ")" + hand + R"(", "origin": "room", "controller": )" +
         controller + "}";
}

// OpenXR: -z points out at the thumb's side, x out of the back of a right hand, out of the palm of
// a left one; so y points to the wrist.
TEST(LandmarkLine, AControllerIsAHandThatHoldsIt) {
  for (const bool left : {false, true}) {
    const auto line = parse_landmarks(controller_line(
        left ? "Left" : "right",
        R"({"position_m": [0.1, 0.2, 0.3], "orientation": [1, 0, 0, 0], "trigger": 0, "grip": 0})"));
    ASSERT_TRUE(line) << line.error();
    EXPECT_EQ(line->left, left);
    EXPECT_EQ(why_no_hand(line->points, left), "");
    const BareHand hand = bare_hand(line->points, left);
    EXPECT_GT(hand.x_R.normalized().dot(-Eigen::Vector3d::UnitY()), 0.95) << "fingers";
    EXPECT_GT(hand.z_R.normalized().dot(Eigen::Vector3d(left ? -1 : 1, 0, 0)), 0.9) << "back";
    EXPECT_LT(line->points[4].z(), 0.3) << "thumb";
    const Eigen::Vector3d palm = (line->points[0] + line->points[9]) / 2;
    EXPECT_LT((palm - Eigen::Vector3d(0.1, 0.2, 0.3)).norm(), 0.001);
  }
}

TEST(LandmarkLine, TriggerAndGripBendTheirFingers) {
  const auto bent = [](double trigger, double grip) {
    const auto line = parse_landmarks(controller_line(
        "right", R"({"position_m": [0, 0, 0], "orientation": [1, 0, 0, 0], "trigger": )" +
                     std::to_string(trigger) + R"(, "grip": )" + std::to_string(grip) + "}"));
    EXPECT_TRUE(line);
    // Its first bone and its last turn against each other.
    std::array<bool, 5> is_bent{};
    const auto bone = [&](std::size_t from, std::size_t to) {
      return (line->points[to] - line->points[from]).normalized();
    };
    for (std::size_t f = 0; f < 5; ++f)
      is_bent[f] = bone(4 * f + 1, 4 * f + 2).dot(bone(4 * f + 3, 4 * f + 4)) < 0.8;
    return is_bent;
  };
  EXPECT_EQ(bent(0, 0), (std::array{false, false, false, false, false}));
  EXPECT_EQ(bent(1, 0), (std::array{true, true, false, false, false}));
  EXPECT_EQ(bent(0, 1), (std::array{true, false, true, true, true}));
}

TEST(LandmarkLine, AControllerThatIsNoneIsRefusedWithItsReason) {
  const auto reason = [](const std::string& controller) {
    return refusal(controller_line("right", controller));
  };
  EXPECT_EQ(reason("3"), "unreadable");
  EXPECT_EQ(reason("{}"), "unreadable");
  const std::string place = R"("position_m": [0, 0, 0], )", pressed = R"("trigger": 0, "grip": 0})";
  EXPECT_EQ(reason("{" + place + R"("orientation": [0, 0, 0, 0], )" + pressed), "not a rotation");
  EXPECT_EQ(reason("{" + place + R"("orientation": [1, 0, 0, null], )" + pressed), "not finite");
  EXPECT_EQ(reason(R"({"position_m": [0, 9, 0], "orientation": [1, 0, 0, 0], )" + pressed),
            "out of range");
  EXPECT_EQ(reason("{" + place + R"("orientation": [1, 0, 0, 0], "trigger": 2, "grip": 0})"),
            "unreadable");
  EXPECT_EQ(reason("{" + place + R"("orientation": [1, 0, 0, 0], )" + pressed), "");
}

TEST(LandmarkLine, SaysWhichButtonsAreHeld) {
  LandmarkLine line = some_line();
  EXPECT_FALSE(parse_landmarks(to_line(line))->held) << "it has none";
  for (const std::vector<std::uint8_t>& held :
       {std::vector<std::uint8_t>{}, std::vector<std::uint8_t>{1},
        std::vector<std::uint8_t>{2, 8}}) {
    line.held = held;
    EXPECT_EQ(parse_landmarks(to_line(line))->held, held);
  }
  const std::string good = to_line(line);
  for (const char* wrong : {"[0]", "[9]", "[-1]", "[1.5]", "true", "1", "[\"1\"]", "[[1]]",
                            "[1,1,1,1,1,1,1,1,1]", "[18446744073709551616]"})
    EXPECT_EQ(refusal(replaced(good, "[2,8]", wrong)), "unreadable") << wrong;
}

// As other trackers mean the same.
TEST(LandmarkLine, UnderstandsWhatOthersWrite) {
  const LandmarkLine truth = some_line();
  const std::string good = to_line(truth), webxr = to_line(truth, true);
  const auto openxr = parse_landmarks(replaced(webxr, "[[", "[[9e9,0,0],["));
  ASSERT_TRUE(openxr) << openxr.error();
  EXPECT_EQ(openxr->points, truth.points) << "26 joints: the palm comes first";
  for (const char* hand : {"\"Right\"", "\"RIGHT\""})
    EXPECT_FALSE(parse_landmarks(replaced(good, "\"right\"", hand))->left) << hand;
  EXPECT_TRUE(parse_landmarks(replaced(good, "\"right\"", "\"Left\""))->left);
  for (const char* stamp : {"1732200000125", "1732200000125000", "1732200000125000000"}) {
    const auto line = parse_landmarks(replaced(good, "1732200000.125", stamp));
    ASSERT_TRUE(line) << line.error();
    EXPECT_NEAR(*line->stamp, 1732200000.125, 1e-5) << stamp;
  }
  EXPECT_EQ(parse_landmarks(replaced(good, "1732200000.125", "12.5"))->stamp, 12.5);
}

TEST(LandmarkLine, NamesTheUnitOfLengths) {
  LandmarkLine line = some_line();
  for (auto& point : line.points) point *= 1000;
  EXPECT_EQ(refusal(to_line(line)), "in millimetres");
  for (auto& point : line.points) point /= 10;
  EXPECT_EQ(refusal(to_line(line)), "in centimetres");
}

TEST(LandmarkLine, DocumentsAreFoundHoweverTheyStand) {
  const std::string one = R"({"a":{"b":"}\"\n{"},"c":[1]})", two = R"({"d":2})";
  const auto is = [](const std::string& text, const std::vector<std::string_view>& documents) {
    return documents_in(text) == documents;
  };
  EXPECT_TRUE(is(one + "\n" + two + "\n", {one, two}));
  EXPECT_TRUE(is(one + two, {one, two}));
  EXPECT_TRUE(is("\n" + one + "\r\n\n", {one}));
  EXPECT_TRUE(is("hello\n" + two, {"hello", two}));
  const std::string odd = "}" + two;
  EXPECT_TRUE(is(odd, {odd}));
  EXPECT_TRUE(is("{\"a\n" + two, {"{\"a", two}));
  EXPECT_TRUE(is("{\"\\", {"{\"\\"}));
  EXPECT_TRUE(is("", {}));
}

TEST(LandmarkLine, SaysWhyItCannotBeUsed) {
  const std::string good = to_line(some_line());
  EXPECT_EQ(refusal(good), "");
  EXPECT_EQ(refusal(""), "unreadable");
  EXPECT_EQ(refusal("[1]"), "unreadable");
  EXPECT_EQ(refusal(good.substr(0, good.size() / 2)), "unreadable");
  EXPECT_EQ(refusal(replaced(good, "\"version\":1", "\"version\":2")), "unknown version");
  EXPECT_EQ(refusal(replaced(good, "\"right\"", "\"both\"")), "unreadable");
  EXPECT_EQ(refusal(replaced(good, "\"room\"", "\"moon\"")), "unreadable");
  EXPECT_EQ(refusal(replaced(good, "1732200000.125", "\"now\"")), "unreadable");
  EXPECT_EQ(refusal(replaced(good, "1732200000.125", "1e300")), "out of range");
  EXPECT_EQ(refusal(replaced(good, "[[", "[[0,0,0],[")), "wrong count");
  EXPECT_EQ(refusal(replaced(good, "[[", "[[null,0,0],[0,0,0],[0,0,0],[0,0,0],[")), "not finite");
  EXPECT_EQ(refusal(replaced(good, "[[", "[[9,0,0],[0,0,0],[0,0,0],[0,0,0],[")), "out of range");
  EXPECT_EQ(refusal(replaced(good, "[[", "[[NaN,0,0],[")), "not finite") << "as Python writes it";
  EXPECT_EQ(refusal(replaced(good, "[[", "[[1e999,0,0],[")), "unreadable");
}

}  // namespace
}  // namespace prehend::glove
