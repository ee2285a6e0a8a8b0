#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "common/base/printable.hpp"
#include "common/dds/participant.hpp"
#include "common/dds/topics.hpp"
#include "common/service/arguments.hpp"
#include "common/service/membership.hpp"
#include "services/robot/tools/commands.hpp"

namespace prehend::robot {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double moving = 0.05;  // rad/s
constexpr auto listens = std::chrono::milliseconds(2500);

struct StatusArguments {
  service::LabArguments lab;
  bool json = false;
};

/// What was heard of the lab's robot.
struct Heard {
  std::optional<v1::ServiceStatus> service;
  int words = 0;  // of the service: the first one is up to a second old
  std::optional<v1::GateState> gate;
  std::optional<v1::HandState> state;
};

std::string word_of(const Heard& heard) {
  if (!heard.service) return "absent";
  const std::string message = heard.service->message().to_string();
  for (const char* word : {"offline", "configured", "homing", "homed", "faulted"})
    if (message.find(word) != std::string::npos && !(heard.gate && heard.gate->stopped()))
      return word;
  if (heard.gate && heard.gate->stopped()) return "stopped";
  if (heard.state)
    for (const double v : heard.state->velocity())
      if (std::abs(v) > moving) return "moving";
  return "ready";
}

int run(const StatusArguments& arguments) {
  const auto config = arguments.lab.load();
  if (!config) return tool::complain(config.error(), exit_wrong_use);
  auto participant =
      dds::Participant::create(service::membership(*config, "robot-status", "viewer"));
  if (!participant) return tool::complain(participant.error(), exit_broken);
  auto services = participant->reader(dds::service_status);
  auto gates = participant->reader(dds::robot_gate);
  auto states = participant->reader(dds::robot_state);
  if (!services) return tool::complain(services.error(), exit_broken);
  if (!gates) return tool::complain(gates.error(), exit_broken);
  if (!states) return tool::complain(states.error(), exit_broken);
  const std::string name = config->text("robot.hand_name");
  Heard heard;
  const auto end = Clock::now() + listens;
  while (Clock::now() < end && !(heard.words > 1 && heard.gate && heard.state)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    for (const auto& sample : services->take())
      if (!sample.info.gone && sample.data.name().to_string() == "robot") {
        heard.service = sample.data;
        ++heard.words;
      }
    for (const auto& sample : gates->take())
      if (!sample.info.gone && sample.data.hand().to_string() == name) heard.gate = sample.data;
    for (const auto& sample : states->take())
      if (!sample.info.gone && sample.data.hand().to_string() == name) heard.state = sample.data;
  }
  const std::string word = word_of(heard);
  const std::string message = heard.service ? heard.service->message().to_string() : "";
  nlohmann::json document{{"hand", name},
                          {"state", word},
                          {"message", message},
                          {"joints_rad", nullptr},
                          {"stopped_by", nullptr}};
  if (heard.state) document["joints_rad"] = heard.state->dof();
  if (heard.gate && heard.gate->stopped())
    document["stopped_by"] = heard.gate->stopped_by().to_string();
  if (arguments.json)
    std::cout << document.dump() << '\n';
  else
    std::cout << fmt::format("{}: {}{}{}\n", name, word, message.empty() ? "" : "; ",
                             printable(message));
  return word == "ready" || word == "moving" ? exit_done : exit_no;
}

}  // namespace

void add_status(tool::Program& program) {
  auto* command =
      program.app().add_subcommand("status", "what the lab's robot service says of its robot");
  const auto a = std::make_shared<StatusArguments>();
  a->lab.add_to(*command);
  command->add_flag("--json", a->json, "a JSON document");
  program.on(*command, [a] { return run(*a); });
}

}  // namespace prehend::robot
