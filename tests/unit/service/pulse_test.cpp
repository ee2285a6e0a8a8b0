// A process answers whether it is alive, or does not: that its loop hangs is seen, and so is that
// it is gone. A task queue stands for the loop.
#include "common/service/pulse.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <thread>

#include "common/service/task_queue.hpp"

namespace prehend::service {
namespace {

const std::string name = "prehend-test/" + std::to_string(::getpid());

std::unique_ptr<Pulse> pulse_of(TaskQueue& tasks) {
  auto made =
      Pulse::create(name, [&tasks](std::function<void()> task) { tasks.post(std::move(task)); });
  EXPECT_TRUE(made) << made.error().message();
  return made ? std::move(*made) : nullptr;
}

TEST(Pulse, ALoopThatRunsAnswers) {
  TaskQueue tasks;
  const auto pulse = pulse_of(tasks);
  const std::jthread loop([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      tasks.run();
      tasks.wait(std::chrono::milliseconds(10));
    }
  });
  for (int i = 0; i < 100; ++i) {
    const auto answered = ask_pulse(name, seconds(10));
    ASSERT_TRUE(answered) << answered.error().message();
  }
}

TEST(Pulse, ALoopThatHangsDoesNot) {
  TaskQueue tasks;
  const auto pulse = pulse_of(tasks);
  // More than may wait for an answer: they are not kept.
  for (int i = 0; i < 40; ++i) EXPECT_FALSE(ask_pulse(name, std::chrono::milliseconds(1)));
  std::atomic<bool> answered = false;
  const std::jthread later([&] {
    // The one that is waiting, and those that came before and have left.
    while (!answered) {
      answered = ask_pulse(name, seconds(10)).has_value();
    }
  });
  while (!answered) {
    tasks.run();
    tasks.wait(std::chrono::milliseconds(10));
  }
}

TEST(Pulse, WhoIsGoneDoesNotAndAnotherTakesThePlace) {
  EXPECT_FALSE(ask_pulse(name, seconds(10)));
  TaskQueue tasks;
  auto pulse = pulse_of(tasks);
  EXPECT_FALSE(Pulse::create(name, [](std::function<void()>) {})) << "taken";
  pulse.reset();
  EXPECT_FALSE(ask_pulse(name, seconds(10)));
  EXPECT_TRUE(pulse_of(tasks));
}

TEST(Pulse, ThatOfAnotherUserIsNotBelieved) {
  if (::geteuid() != 0) GTEST_SKIP() << "takes root, to be somebody else";
  TaskQueue tasks;
  ASSERT_EQ(::seteuid(65534), 0);
  const auto pulse = pulse_of(tasks);
  // Root believes everybody: a third one asks.
  ASSERT_EQ(::seteuid(0), 0);
  ASSERT_EQ(::seteuid(65533), 0);
  const auto asked = ask_pulse(name, seconds(10));
  ASSERT_EQ(::seteuid(0), 0);
  ASSERT_FALSE(asked);
  EXPECT_EQ(asked.error().what, "another user answers there");
}

TEST(Pulse, ANameThatIsTooLongIsAnError) {
  EXPECT_FALSE(Pulse::create(std::string(200, 'x'), [](std::function<void()>) {}));
  EXPECT_FALSE(ask_pulse(std::string(200, 'x'), seconds(1)));
}

}  // namespace
}  // namespace prehend::service
