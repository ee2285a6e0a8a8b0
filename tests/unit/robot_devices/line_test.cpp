// The line to a robot at whose port somebody else is plugged in: one line says who, for each driver
// of a serial robot.
#include "services/robot/devices/line.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/model/hand_model.hpp"
#include "tests/support/strange_port.hpp"

namespace prehend::robot {
namespace {

using testing::HasSubstr;

/// What a robot that any serial driver speaks with cannot answer wrongly: it says something.
class Caller final : public Driver {
 public:
  void connected(Time) override { trouble_ = "does not answer"; }
  void disconnected(const std::string& why) override { be(Phase::offline, why); }
  std::string step(std::string_view, Time now) override {
    if (now - asked_ < std::chrono::milliseconds(50)) return {};
    asked_ = now;
    return "who are you?\r";
  }
  std::string farewell() override { return {}; }
  void home() override {}
  void follow(const Eigen::VectorXd&, const Eigen::VectorXd&, Time) override {}
  void hold() override {}
  void answered() { be(Phase::ready); }

 private:
  Time asked_{};
};

constexpr Duration patience = std::chrono::seconds(20);

TEST(RobotLine, SaysWhoSpeaksInsteadOfTheRobot) {
  for (const test::Stranger who : test::all_strangers) {
    const test::StrangePort port(who);
    Caller driver;
    Line line(driver, serial_channel(port.path(), 9600));
    const auto message = [&] { return line.trouble(port.path(), "is it on?").message(); };
    EXPECT_TRUE(exchange_until(line, patience, [&] {
      return message().find("heard instead") != std::string::npos;
    })) << port.quote();
    EXPECT_THAT(message(), HasSubstr(port.quote()));
    EXPECT_THAT(message(), HasSubstr(port.path() + ": does not answer"));
    driver.answered();
    EXPECT_EQ(line.trouble().what, "");  // who answers is no stranger
  }
}

TEST(RobotLine, EachSerialDriverIsHeardOutWhileItWaits) {
  const auto hand = model::HandModel::load(model::hand_directory("barrett"));
  ASSERT_TRUE(hand);
  const auto kind = find_driver("barrett");
  ASSERT_TRUE(kind);
  const test::StrangePort port(test::Stranger::prompt);
  auto driver = (*kind)->create(*hand, {});
  ASSERT_TRUE(driver);
  Line line(**driver, serial_channel(port.path(), 9600));
  EXPECT_TRUE(exchange_until(line, patience, [&] {
    return line.trouble().message().find(port.quote()) != std::string::npos;
  })) << line.trouble().message();
}

}  // namespace
}  // namespace prehend::robot
