// prehend-teach: a person shows postures, and a training set is made of them.
#include "services/mapping/tools/teach/teach_command.hpp"

#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/base/finite_number.hpp"
#include "common/base/log.hpp"
#include "common/service/arguments.hpp"
#include "common/service/shell.hpp"
#include "services/mapping/files/model_places.hpp"
#include "services/mapping/tools/teach/teach_recording.hpp"
#include "services/mapping/tools/teach/teach_session.hpp"
#include "services/mapping/tools/training/derived_scheme.hpp"
#include "services/mapping/tools/training/first_use.hpp"
#include "services/mapping/tools/training/teach.hpp"

namespace prehend::mapping {
namespace {

struct Arguments {
  service::LabArguments lab;
  std::string hand, scheme, user = "someone", output, from;
  std::vector<std::string> labels;  // POSTURE@SECONDS
  int takes = 1, postures = 7;
  double limit = 600;
  bool grasps = false, json = false, consent = false;

  void add_to(CLI::App& app) {
    lab.add_to(app);
    app.add_option("--hand", hand, "kind of robot hand; default: the lab's");
    app.add_option("--scheme", scheme, "a name in schemes/ or a file; default: the hand's");
    app.add_option("--user", user, "who shows the postures")->capture_default_str();
    app.add_option("-o,--output", output, "training set to write")->required();
    app.add_option("--takes", takes, "how often everything is shown")
        ->check(CLI::Range(1, 100))
        ->capture_default_str();
    app.add_option("--postures", postures, "basic postures: 4, 7, 10 or 13")
        ->check(CLI::IsMember({4, 7, 10, 13}))
        ->capture_default_str();
    app.add_flag("--grasps", grasps, "also ask for each grasp of trained/HAND.grasps");
    app.add_option("--from", from, "a recording (prehend record) instead of a glove");
    app.add_option("--label", labels,
                   "with --from: what was shown when, POSTURE@SECONDS; repeatable")
        ->type_size(1)
        ->allow_extra_args(false);
    app.add_option("--limit", limit, "s after which it gives up")->check(CLI::Range(1.0, 1e6));
    app.add_flag("--consent", consent,
                 "the space bar, while it is held, is the deadman of the lab's hand");
    app.add_flag("--json", json, "print the outcome as one JSON document");
  }
};

/// Exit code of the session; 0 when all was shown.
int teach(const Arguments& arguments, Teacher& teacher) {
  const auto shell = service::Shell::create(
      arguments.lab.for_service(), {"teach", "Learns postures from a person.", "operator", false});
  if (!shell) return service::complain(shell.error());
  TeachSession session(**shell, teacher, seconds(arguments.limit), arguments.consent);
  (*shell)->status().running();
  const auto ended = (*shell)->run();
  return ended ? *ended : service::complain(ended.error());
}

/// «POSTURE@SECONDS»
Expected<std::multimap<std::string, double>> parse_labels(const std::vector<std::string>& texts) {
  std::multimap<std::string, double> labels;
  for (const std::string& text : texts) {
    const auto at = text.rfind('@');
    const auto time = at == std::string::npos
                          ? std::nullopt
                          : finite_number(std::string_view(text).substr(at + 1));
    if (!time) return fail("must be POSTURE@SECONDS", "--label " + text, "for example open@2.5");
    labels.emplace(text.substr(0, at), *time);
  }
  return labels;
}

Expected<std::vector<RobotGrasp>> held_grasps(const std::string& name,
                                              const model::HandModel& hand) {
  const auto ready = ready_places(name, hand, Needs::model_and_grasps);
  if (!ready) return tl::unexpected(ready.error());
  auto grasps = load_robot_grasps(ready->grasps, hand);
  if (grasps) std::erase_if(*grasps, [](const RobotGrasp& grasp) { return !grasp.held; });
  return grasps;
}

int run(Arguments arguments) {
  const auto broken = [](const Error& error) { return service::complain(error, exit_broken); };
  const auto labels = parse_labels(arguments.labels);
  if (!labels) return service::complain(labels.error(), exit_wrong_use);
  if (arguments.hand.empty()) {
    const auto config = arguments.lab.load();
    if (!config) return service::complain(config.error(), exit_wrong_use);
    arguments.hand = config->text("mapping.hand");
  }
  if (arguments.hand.empty())
    return service::complain({"names no hand", "--hand", model::hand_hint()}, exit_wrong_use);
  const auto hand = model::HandModel::load(model::hand_directory(arguments.hand));
  if (!hand) return broken(hand.error());
  const ModelPlaces places = model_places(arguments.hand);
  const auto scheme = arguments.scheme.empty() ? load_or_derive(places.scheme, *hand)
                                               : Scheme::load(scheme_path(arguments.scheme), *hand);
  if (!scheme) return broken(scheme.error());
  std::vector<RobotGrasp> grasps;
  if (arguments.grasps) {
    auto held = held_grasps(arguments.hand, *hand);
    if (!held) return broken(held.error());
    grasps = std::move(*held);
  }
  const auto asked =
      curriculum(*hand, *scheme, arguments.user, arguments.takes, arguments.postures, grasps);

  std::vector<Shown> shown;
  const auto begin = std::chrono::steady_clock::now();
  if (arguments.from.empty()) {
    Teacher teacher(asked, {});
    if (const int code = teach(arguments, teacher); code != 0) return code;
    if (teacher.asked()) return exit_no;  // interrupted
    shown = teacher.shown();
  } else {
    auto found = shown_in(arguments.from, *labels, asked, {});
    if (!found) return broken(found.error());
    shown = std::move(*found);
  }
  const double took =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();

  const learning::TrainingSet set = taught_set(*hand, *scheme, shown);
  if (auto ok = learning::check(set); !ok) return broken(ok.error());
  if (auto ok = check_consistent(set); !ok) return broken(ok.error());
  if (auto saved = learning::save(arguments.output, set); !saved) return broken(saved.error());
  if (arguments.json) {
    nlohmann::json document{{"output", arguments.output}, {"seconds", took}};
    for (const Shown& one : shown)
      document["postures"].push_back({{"posture", label_of(one.pair)},
                                      {"take", one.pair.take},
                                      {"quality", one.quality},
                                      {"wobble_m", one.wobble}});
    std::cout << document.dump(2) << '\n';
  } else {
    log::info("{} postures in {:.0f} s, {}", shown.size(), took, arguments.output);
  }
  return exit_done;
}

}  // namespace

int teach_command(const std::vector<std::string>& texts) {
  log::set_name("teach");
  CLI::App app{
      "Asks a person with a glove for one posture after the other and takes each when the hand\n"
      "keeps still. `prehend train --set FILE` learns from what was shown. A recording of the\n"
      "session (prehend record) can be used again by --from.",
      "prehend teach"};
  Arguments arguments;
  arguments.add_to(app);
  if (const auto code = service::parse(app, texts)) return *code;
  return run(arguments);
}

}  // namespace prehend::mapping
