// A motor that follows, presses and is stuck, in counts and computed time.
#include <gtest/gtest.h>

#include "services/robot/core/barrett_driver.hpp"

namespace prehend::robot::barrett {
namespace {

constexpr double scale = 7000;  // counts/rad
constexpr Duration period = std::chrono::milliseconds(10);

/// A motor that does what it is told, unless something is in its way.
class Motor {
 public:
  Motor()
      : control_({.speed = 2.5 * scale,
                  .press = 0.4 * scale,
                  .squeeze = 0.15 * scale,
                  .counts_per_radian = scale}) {
    control_.observe(0, now_);
  }

  MotorControl& control() { return control_; }
  double position() const { return position_ / scale; }
  Time now() const { return now_; }
  void run(double seconds_long, double factor = 1, double wall = 1e9) {
    for (const Time end = now_ + seconds(seconds_long); now_ < end;) {
      const double v = control_.command(now_);
      fastest_ = std::max(fastest_, std::abs(v));
      position_ = std::min(position_ + factor * v * to_seconds(period), wall * scale);
      now_ += period;
      control_.observe(position_, now_);
    }
  }
  /// Nothing is heard of it meanwhile.
  void rest(double seconds_long) {
    control_.rest();
    now_ += seconds(seconds_long);
  }
  double fastest() const { return fastest_ / scale; }
  double commanded() { return control_.command(now_) / scale; }

 private:
  MotorControl control_;
  double position_ = 0, fastest_ = 0;
  Time now_ = from_ns(1'000'000'000);
};

TEST(MotorControl, GetsThereAndNeverFasterThanItMay) {
  // The unit of a velocity may be mistaken by a factor: the loop is closed over the position.
  for (const double factor : {0.5, 1.0, 2.0}) {
    Motor motor;
    motor.control().follow(2 * scale, 1, motor.now());
    motor.run(4, factor);
    EXPECT_NEAR(motor.position(), 2, 0.003) << factor;
    EXPECT_LE(motor.fastest(), 2.5 + 1e-9);
  }
}

TEST(MotorControl, FollowsAMovingTargetClosely) {
  Motor motor;
  double target = 0;
  for (int n = 0; n < 100; ++n) {
    target += 0.01;  // 1 rad/s
    motor.control().follow(target * scale, 1, motor.now());
    motor.run(0.01);
  }
  EXPECT_NEAR(motor.position(), target, 0.02);
}

TEST(MotorControl, PressesGentlyAgainstWhatIsInItsWay) {
  Motor motor;
  motor.control().follow(1.15 * scale, 1, motor.now());
  motor.run(2, 1, 1.0);
  EXPECT_TRUE(motor.control().stalled());
  EXPECT_NEAR(motor.commanded(), 0.4, 1e-9);
  EXPECT_NEAR(motor.control().effort(), 1, 1e-9);
  // So it does a little past the contact: by its velocity, not by how far that is.
  motor.control().follow(1.04 * scale, 1, motor.now());
  motor.run(1, 1, 1.0);
  EXPECT_NEAR(motor.control().effort(), 1, 1e-9);
  motor.control().follow(1.15 * scale, 1, motor.now());
  motor.run(1, 1, 1.0);
  EXPECT_FALSE(motor.control().stuck());
  // Half the effort is half the velocity that is missing.
  motor.control().follow(1.15 * scale, 0.1, motor.now());
  motor.run(1, 1, 1.0);
  EXPECT_TRUE(motor.control().stalled());
  EXPECT_NEAR(motor.commanded(), 0.04, 1e-9);
  // It lets go at once.
  motor.control().follow(0.5 * scale, 1, motor.now());
  motor.run(1, 1, 1.0);
  EXPECT_NEAR(motor.position(), 0.5, 0.003);
  EXPECT_FALSE(motor.control().stalled());
}

TEST(MotorControl, HoldingKeepsASqueezeAndNothingElse) {
  Motor free;
  free.control().follow(2 * scale, 1, free.now());
  free.run(0.3);
  const double where = free.position();
  free.control().hold();
  free.run(1);
  EXPECT_NEAR(free.position(), where, 0.01);
  Motor pressing;
  pressing.control().follow(1.4 * scale, 1, pressing.now());
  pressing.run(1, 1, 1.0);
  pressing.control().hold();
  EXPECT_NEAR(pressing.commanded(), 0.4, 1e-9);
  EXPECT_FALSE(pressing.control().stuck());
}

// A finger that had stalled before its cable was cut moved by a squeeze when it was back, though
// stopped.
TEST(MotorControl, AfterItWasAwayItStaysWhereItIsFound) {
  Motor pressing;
  pressing.control().follow(1.4 * scale, 1, pressing.now());
  pressing.run(1, 1, 1.0);
  ASSERT_TRUE(pressing.control().stalled());
  pressing.control().forget();
  pressing.control().observe(0.2 * scale, pressing.now() + seconds(5));
  pressing.control().hold();
  EXPECT_EQ(pressing.commanded(), 0);
  EXPECT_FALSE(pressing.control().stalled());
}

TEST(MotorControl, FarFromItsTargetForLongItIsStuck) {
  Motor motor;
  motor.control().follow(1.5 * scale, 1, motor.now());
  motor.run(3, 1, 0.2);
  EXPECT_TRUE(motor.control().stuck());
}

// When an answer is late nothing is asked until none can come any more. A motor that then needed a
// moment to start was stuck at once.
TEST(MotorControl, AGapInWhatIsHeardDoesNotMakeItStuck) {
  Motor motor;
  motor.run(0.5);  // it stands
  motor.rest(1.1);
  motor.control().follow(1.5 * scale, 1, motor.now());
  motor.run(0.15, 1, motor.position());
  EXPECT_FALSE(motor.control().stuck());
  motor.run(1.2, 1, motor.position());
  EXPECT_TRUE(motor.control().stuck());
}

}  // namespace
}  // namespace prehend::robot::barrett
