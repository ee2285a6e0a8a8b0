#include "services/cli/tools/demo/onlooker.hpp"

#include <fmt/format.h>

#include <csignal>
#include <thread>

#include "common/arm/mounting.hpp"
#include "common/model/arm_choice.hpp"
#include "common/model/hand_model.hpp"

namespace prehend::cli {
namespace {

volatile std::sig_atomic_t interrupted = 0;

/// Ctrl-C ends the demonstration, not this program at once, so that the services are stopped.
void watch_for_interrupts() {
  struct sigaction action {};
  action.sa_handler = [](int) { interrupted = 1; };
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) ::sigaction(number, &action, nullptr);
}

}  // namespace

Onlooker::Onlooker(const Progress& progress, double patience)
    : progress_(progress),
      end_(std::chrono::steady_clock::now() +
           std::chrono::duration_cast<std::chrono::steady_clock::duration>(seconds(patience))) {
  watch_for_interrupts();
}

Trouble Onlooker::listen(const service::Config& config, const std::optional<model::Scene>& truth) {
  observer_ = Observer(truth);
  if (const auto trouble = expect_arm(config)) return trouble;
  auto listener = Listener::create(config, true);
  if (!listener) return broken(listener.error());
  listener_.emplace(std::move(*listener));
  return std::nullopt;
}

Trouble Onlooker::expect_arm(const service::Config& config) {
  const std::string& name = config.text("robot.arm");
  if (name.empty()) return std::nullopt;
  const auto arm = model::load_arm(name);
  if (!arm) return wrong(arm.error());
  std::vector<double> speeds;
  for (const model::ArmJoint& joint : arm->joints) speeds.push_back(joint.velocity);
  observer_.expect_arm(arm->name, speeds);
  const auto hand = model::HandModel::load(model::hand_directory(config.text("simulation.hand")));
  if (!hand) return wrong(hand.error());
  if (const auto fits = arm::check_fit(*arm, *hand); !fits) return wrong(fits.error());
  return std::nullopt;
}

void Onlooker::mind(service::Lab& lab, const std::string& may_end) {
  lab_ = &lab;
  may_end_ = may_end;
}

Trouble Onlooker::step(const std::string& what) {
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  listener_->poll(observer_);
  progress_(fmt::format("{:<12} {}", what, observer_.progress()));
  if (interrupted) return Failure{{"interrupted", "demo", ""}, exit_no};
  if (lab_)
    if (const auto casualty = lab_->casualty(may_end_)) return broken(*casualty);
  return std::nullopt;
}

Trouble Onlooker::await(const std::string& what, const std::function<bool()>& is_there,
                        const std::function<Error()>& late) {
  while (!is_there()) {
    if (const auto trouble = step(what)) return trouble;
    if (is_late()) return broken(late());
  }
  return std::nullopt;
}

}  // namespace prehend::cli
