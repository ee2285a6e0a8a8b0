// Others' Modbus on a pseudo-terminal: libmodbus carries an emulated gripper's registers for our
// driver, with what can go wrong with such a gripper; and asks our emulated gripper as its host.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <modbus/modbus.h>
#include <termios.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <thread>

#include "common/serial/pseudo_terminal.hpp"
#include "services/robot/core/robotiq_driver.hpp"
#include "services/robot/core/robotiq_emulator.hpp"
#include "services/robot/devices/emulation.hpp"
#include "services/robot/devices/line.hpp"

namespace prehend::robot::robotiq {
namespace {

const model::HandModel& hand() {
  static const auto loaded = model::HandModel::load(model::hand_directory("robotiq_2f85"));
  return *loaded;
}

Eigen::VectorXd at(double value) {
  return Eigen::VectorXd::Constant(1, value);
}

Duration since_start() {
  static const auto start = std::chrono::steady_clock::now();
  return std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now() - start);
}

struct FreeContext {
  void operator()(modbus_t* context) const { modbus_free(context); }
};
struct FreeMap {
  void operator()(modbus_mapping_t* map) const { modbus_mapping_free(map); }
};
using Context = std::unique_ptr<modbus_t, FreeContext>;
using Mapping = std::unique_ptr<modbus_mapping_t, FreeMap>;

/// A gripper behind the server side of libmodbus.
class Served {
 public:
  explicit Served(int id) : gripper_(hand(), kind_2f85, false, 1), id_(id) {
    master_ = ::posix_openpt(O_RDWR | O_NOCTTY);
    ::grantpt(master_);
    ::unlockpt(master_);
    path_ = ::ptsname(master_);
    // Fresh ones echo and wait for ends of lines; and somebody must have it open.
    slave_ = ::open(path_.c_str(), O_RDWR | O_NOCTTY);
    termios raw{};
    ::tcgetattr(slave_, &raw);
    ::cfmakeraw(&raw);
    ::tcsetattr(slave_, TCSANOW, &raw);
    thread_ = std::thread([this] { serve(); });
  }
  ~Served() {
    ends_ = true;
    thread_.join();
    ::close(slave_);
    ::close(master_);
  }
  const std::string& path() const { return path_; }
  void answers_to(int id) { id_ = id; }
  void falls_silent(bool silent) { silent_ = silent; }
  template <class Change>
  auto with(const Change& change) {
    const std::scoped_lock lock(mutex_);
    gripper_.pass(since_start());
    return change(gripper_);
  }

 private:
  void serve() {
    const Context context(modbus_new_rtu("/dev/null", 115200, 'N', 8, 1));
    modbus_set_socket(context.get(), master_);
    // It waits so long for what another answers to a request that is not its own, and swallows what
    // comes meanwhile.
    modbus_set_response_timeout(context.get(), 0, 20000);
    modbus_set_byte_timeout(context.get(), 0, 20000);
    modbus_set_indication_timeout(context.get(), 0, 20000);
    const Mapping map(
        modbus_mapping_new_start_address(0, 0, 0, 0, action_at, 1100, action_at, 1100));
    std::uint8_t request[MODBUS_RTU_MAX_ADU_LENGTH];
    while (!ends_) {
      modbus_set_slave(context.get(), id_);
      const int size = modbus_receive(context.get(), request);
      if (size <= 0 || silent_) continue;
      const std::scoped_lock lock(mutex_);
      gripper_.pass(since_start());
      gripper_.hear(since_start());
      for (std::uint16_t* registers : {map->tab_input_registers, map->tab_registers})
        for (std::size_t i = 0; i < register_count; ++i)
          registers[status_at - action_at + i] = gripper_.map.status[i];
      modbus_reply(context.get(), request, size, map.get());
      if (request[1] == MODBUS_FC_WRITE_MULTIPLE_REGISTERS)
        gripper_.map.written.assign(map->tab_registers, map->tab_registers + register_count);
      gripper_.pass(since_start());
    }
  }

  Gripper gripper_;
  std::mutex mutex_;  // guards gripper_
  std::atomic<int> id_;
  std::atomic<bool> ends_ = false, silent_ = false;
  int master_ = -1, slave_ = -1;
  std::string path_;
  std::thread thread_;
};

class RobotiqOnModbus : public testing::Test {
 protected:
  bool until(const std::function<bool()>& done, double limit_s = 20) {
    return exchange_until(line_, seconds(limit_s), done);
  }
  bool is(Phase phase) {
    return until([&] { return driver_.phase() == phase; });
  }
  void make_ready() {
    ASSERT_TRUE(is(Phase::configured)) << driver_.trouble();
    driver_.home();
    ASSERT_TRUE(until([&] { return driver_.phase() != Phase::homing; }));
    ASSERT_EQ(driver_.phase(), Phase::ready) << driver_.trouble();
  }
  bool goes_to(double value) {
    driver_.follow(at(value), {}, {});
    return until([&] { return std::abs(driver_.reading()->dof[0] - value) < 0.01; });
  }

  Served served_{usual_id};
  // Only silence is to be a lost wire, not a busy machine.
  Driver driver_{hand(), {.baud = 115200, .lost_after = seconds(5)}, kind_2f85};
  Line line_{driver_, serial_channel(served_.path(), 115200)};
};

TEST_F(RobotiqOnModbus, IsActivatedAndGoesWhereItIsTold) {
  ASSERT_NO_FATAL_FAILURE(make_ready());
  EXPECT_TRUE(goes_to(0.6));
  EXPECT_NEAR(served_.with([](Gripper& gripper) { return gripper.measured(); }), 0.6, 0.01);
  EXPECT_TRUE(goes_to(0.2));
  // What comes is understood; on a busy machine an answer may come too late, when something else
  // has been asked.
  for (const std::string& reason : driver_.take_rejects())
    EXPECT_THAT(reason, testing::AnyOf("no answer", "answer to another question"));
}

TEST_F(RobotiqOnModbus, TellsWhatItHolds) {
  ASSERT_NO_FATAL_FAILURE(make_ready());
  served_.with([](Gripper& gripper) { gripper.measure(0.1); });
  driver_.follow(at(0.6), at(4), {});
  EXPECT_TRUE(until([&] { return driver_.reading()->effort[0] > 3.5; }));
  EXPECT_EQ(driver_.phase(), Phase::ready);
}

TEST_F(RobotiqOnModbus, ALostActivationIsNamed) {
  ASSERT_NO_FATAL_FAILURE(make_ready());
  ASSERT_TRUE(goes_to(0.5));
  served_.with([](Gripper& gripper) { gripper.restart(); });
  EXPECT_TRUE(is(Phase::configured));
  EXPECT_NE(driver_.trouble().find("it has lost its activation"), std::string::npos)
      << driver_.trouble();
}

TEST_F(RobotiqOnModbus, SilenceIsALostWireAndEnds) {
  ASSERT_NO_FATAL_FAILURE(make_ready());
  ASSERT_TRUE(goes_to(0.5));
  served_.falls_silent(true);
  EXPECT_TRUE(is(Phase::faulted));
  EXPECT_EQ(driver_.trouble(), "the wire is lost");
  served_.falls_silent(false);
  EXPECT_TRUE(is(Phase::ready)) << driver_.trouble();
  EXPECT_NEAR(driver_.reading()->dof[0], 0.5, 0.01);
  EXPECT_TRUE(goes_to(0.3));
}

TEST_F(RobotiqOnModbus, AnotherIdIsNotThere) {
  served_.answers_to(10);
  EXPECT_FALSE(until([&] { return driver_.phase() != Phase::offline; }, 1));
  EXPECT_EQ(driver_.trouble(), "does not answer");
  served_.answers_to(usual_id);
  EXPECT_TRUE(is(Phase::configured)) << driver_.trouble();
}

/// libmodbus asks, our emulated gripper answers.
class AskedByLibmodbus : public testing::Test {
 protected:
  AskedByLibmodbus() : terminal_(*serial::PseudoTerminal::open({})) {
    thread_ = std::thread([this] {
      while (!ends_) {
        const std::string heard = terminal_.read(std::chrono::milliseconds(2));
        const std::string said = emulator_.receive(heard, since_start());
        if (!said.empty()) terminal_.write(said);
      }
    });
    context_.reset(modbus_new_rtu(terminal_.path().c_str(), 115200, 'N', 8, 1));
    modbus_set_slave(context_.get(), usual_id);
  }
  ~AskedByLibmodbus() override {
    modbus_close(context_.get());
    ends_ = true;
    thread_.join();
  }

  Emulator emulator_{hand(), kind_2f85, {.initialized = true}};
  serial::PseudoTerminal terminal_;
  std::atomic<bool> ends_ = false;
  std::thread thread_;
  Context context_;
};

TEST_F(AskedByLibmodbus, OurEmulatedGripperAnswersInEachWay) {
  ASSERT_EQ(modbus_connect(context_.get()), 0) << modbus_strerror(errno);
  const modbus::Registers close = encode(Action{active | goes, 120, 255, 255});
  EXPECT_EQ(modbus_write_registers(context_.get(), action_at, 3, close.data()), 3)
      << modbus_strerror(errno);
  modbus::Registers status(3);
  EXPECT_EQ(modbus_read_input_registers(context_.get(), status_at, 3, status.data()), 3);
  EXPECT_EQ(status_of(status).goal, 120);
  EXPECT_EQ(modbus_read_registers(context_.get(), status_at, 3, status.data()), 3);
  EXPECT_EQ(status_of(status).goal, 120);
  const modbus::Registers open = encode(Action{active | goes, 60, 255, 255});
  EXPECT_EQ(modbus_write_and_read_registers(context_.get(), action_at, 3, open.data(), status_at, 3,
                                            status.data()),
            3);
  EXPECT_EQ(modbus_read_input_registers(context_.get(), 1500, 1, status.data()), -1);
  EXPECT_EQ(errno, EMBXILADD);
}

}  // namespace
}  // namespace prehend::robot::robotiq
