// `prehend tasks demo`, which is `prehend demo --task`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/base/paths.hpp"
#include "common/base/to_terminal.hpp"
#include "common/model/catalogue.hpp"
#include "common/tasks/files/task_file.hpp"
#include "services/performer/tools/play/task_play.hpp"
#include "services/performer/tools/tasks/commands.hpp"
#include "services/performer/tools/tasks/news.hpp"

namespace prehend::performer {
namespace {

using Json = nlohmann::ordered_json;

/// The same keys as of `prehend demo`, and those of the task.
Json document_of(const TaskPlayOutcome& outcome, const TaskPlayOptions& options) {
  const std::string& object = outcome.task.steps.front().object;
  const auto number = [](const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
  };
  Json named{{"name", object}, {"shape", nullptr}, {"size_m", nullptr}};
  const auto config = options.lab.load();
  const auto catalogue =
      config ? model::Catalogue::load(config->path("lab.catalogue")) : model::Catalogue{};
  if (const auto* known = catalogue ? catalogue->find(object) : nullptr) {
    named["shape"] = model::to_string(known->shape.kind);
    named["size_m"] = {known->shape.size.x(), known->shape.size.y(), known->shape.size.z()};
  }
  named["position_error_m"] = number(outcome.place_error);
  const auto grasp = outcome.grasp.value_or(TaskPlayOutcome::Grasp{});
  Json document{{"object", named},
                // No mapping runs: a performer plans the grasp.
                {"mapping",
                 {{"mode", nullptr},
                  {"weight", nullptr},
                  {"hand", outcome.hand},
                  {"grasp_type", outcome.grasp_type}}},
                {"grasp",
                 {{"contacts", grasp.contacts},
                  {"epsilon", grasp.epsilon},
                  {"volume", grasp.volume},
                  {"force_closure", grasp.force_closure},
                  {"held", grasp.held}}},
                {"latency_ms", nullptr},
                {"glove", {{"device", "person"}, {"frames", outcome.frames}, {"rejected", 0}}},
                {"understood", {{"phases", Json::array()}, {"steps", Json::array()}}},
                {"task",
                 {{"name", outcome.task.name},
                  {"done", outcome.done},
                  {"reason", outcome.reason},
                  {"steps", Json::array()}}}};
  if (const auto& arm = outcome.arm)
    document["arm"] = {{"name", arm->name()},
                       {"worst_joint_speed", arm->worst_joint_speed()},
                       {"out_of_reach", arm->out_of_reach()}};
  for (const auto& phase : outcome.phases)
    document["understood"]["phases"].push_back({{"phase", phase.name},
                                                {"object", phase.object},
                                                {"begin_s", phase.begin},
                                                {"end_s", phase.end}});
  for (const tasks::Step& step : outcome.task.steps)
    document["understood"]["steps"].push_back(
        {{"object", step.object}, {"grasp", step.grasp}, {"reference", step.reference}});
  for (const auto& step : outcome.steps)
    document["task"]["steps"].push_back({{"object", step.object},
                                         {"done", step.done},
                                         {"error_m", step.error},
                                         {"error_rad", step.turn},
                                         {"reason", step.reason}});
  return document;
}

void print(const TaskPlayOutcome& outcome) {
  if (!outcome.phases.empty()) to_terminal("seen\n");
  for (const auto& phase : outcome.phases)
    to_terminal("  {:5.2f} to {:5.2f} s  {:9} {}\n", phase.begin, phase.end, phase.name,
                phase.object);
  to_terminal("understood as {}\n", outcome.task.name);
  for (const tasks::Step& step : outcome.task.steps) {
    const Eigen::Vector3d p = step.X_RO.translation();
    to_terminal("  {}: {}, to {:.1f}, {:.1f} cm of the {}, {:.0f} cm over what is lower{}\n",
                step.object, step.grasp.empty() ? "any grasp" : step.grasp, 100 * p.x(),
                100 * p.y(), step.reference, 100 * step.via_height,
                step.upright ? ", upright" : "");
  }
  if (outcome.place_error)
    to_terminal("  the place is {:.1f} mm from where the person put it\n",
                1000 * *outcome.place_error);
  to_terminal("done again by {}{}, from elsewhere: {}\n", outcome.hand,
              outcome.arm ? " on " + outcome.arm->name() : "",
              outcome.done ? "as it was shown" : "no: " + outcome.reason);
  for (const auto& step : outcome.steps)
    to_terminal("  {:16} {:8} {:5.1f} mm {:5.1f}° off\n", step.object,
                step.done ? "done" : "not done", 1000 * step.error, step.turn * 57.29578);
}

int demo(const TaskPlayOptions& options, bool json) {
  const auto outcome = play_task(options);
  end_news();
  if (!outcome) return tool::complain(outcome.error());
  if (json)
    std::cout << document_of(*outcome, options)
                     .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)
              << "\n";
  else
    print(*outcome);
  return outcome->done ? exit_done : exit_no;
}

}  // namespace

void add_demo(tool::Program& program) {
  struct Arguments {
    TaskPlayOptions demo;
    bool json = false, quiet = false;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = program.app().add_subcommand(
      "demo",
      "A person who does not exist shows a task to a lab of processes on this machine; everything "
      "is moved\nelsewhere, and a simulated robot hand does it again and is judged. Exit code 0: "
      "as it was shown, 1: not.");
  TaskPlayOptions& demo_options = arguments->demo;
  demo_options.lab.add_to(*command);
  command->add_option("--task", demo_options.task, "what it is called, or a file NAME.task")
      ->capture_default_str();
  command->add_option("--object", demo_options.object, "what is put elsewhere")
      ->capture_default_str();
  command->add_option("--hand", demo_options.hand, "the robot hand");
  command->add_option("--arm", demo_options.arm,
                      "the arm that carries it, a name or folder: puma560; else it flies");
  command->add_option("--seed", demo_options.seed, "draws person, places, times and noise");
  command->add_option("--timeout", demo_options.timeout, "s until it gives up")
      ->check(CLI::Range(1.0, 3600.0));
  command->add_flag("--keep", demo_options.keep, "keep scenes, task and logs");
  command->add_flag("--json", arguments->json, "one JSON document");
  command->add_flag("--quiet", arguments->quiet, "no progress");
  program.on(*command, [arguments] {
    if (!arguments->json && !arguments->quiet) arguments->demo.tell = show_news;
    return demo(arguments->demo, arguments->json);
  });
}

}  // namespace prehend::performer
