// `prehend hand add`: a URDF becomes a hand of the lab, with a report of how well it fits.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <fstream>
#include <iostream>
#include <memory>

#include "common/base/log.hpp"
#include "common/base/to_terminal.hpp"
#include "common/grasping/candidates.hpp"
#include "services/planner/tools/hand/commands.hpp"
#include "services/planner/tools/hand/fit.hpp"
#include "services/planner/tools/hand/hand_page.hpp"
#include "services/planner/tools/hand_import/finding_report.hpp"
#include "services/planner/tools/hand_import/make_hand.hpp"
#include "services/planner/tools/hand_import/palms.hpp"
#include "services/planner/tools/hand_import/robot_file.hpp"
#include "services/planner/tools/planning/planning_task.hpp"

namespace prehend::planner {
namespace {

struct AddArguments {
  service::CatalogueArgument catalogue;
  std::string file, name, output, palm;
  std::vector<std::string> fingers;  // FINGER=LINK
  int candidates = 60;
  bool json = false;
  RobotFileOptions options;
};

Expected<void> write_folder(const MadeHand& hand, const std::filesystem::path& folder) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  for (const auto& [name, text] :
       {std::pair("hand.urdf", &hand.urdf), std::pair("hand.toml", &hand.toml)}) {
    std::ofstream stream(folder / name, std::ios::binary);
    if (!(stream << *text) || !stream.flush())
      return fail("cannot be written", (folder / name).string(),
                  "is there room, and is the folder writable?");
  }
  return {};
}

/// One object of the trial: the best planned grasp and whether it survived lift, shake and turn.
nlohmann::ordered_json trial(const MadeHand& hand, const grasping::Body& body, int candidates,
                             std::vector<Trial>& shown) {
  const auto plan = planner::plan_in_batches(hand.model, body, candidates, 0);
  nlohmann::ordered_json document{{"object", body.name},
                                  {"width_m", grasping::narrowest_width(body.shape)},
                                  {"held", plan && plan->held()},
                                  {"epsilon", nullptr},
                                  {"reason", nullptr}};
  if (!plan)
    document["reason"] = plan.error().message();
  else if (!plan->held())
    document["reason"] = plan->reason;
  shown.push_back({body, {}});
  if (plan && !plan->grasps.empty()) {
    shown.back().best = plan->grasps.front();
    document["epsilon"] = plan->grasps.front().quality.epsilon;
  }
  return document;
}

nlohmann::ordered_json report(const MadeHand& hand, const std::vector<grasping::Body>& bodies,
                              const AddArguments& arguments, std::vector<Trial>& shown) {
  nlohmann::ordered_json document{{"name", arguments.name}, {"folder", arguments.output}};
  document["dofs"] = nlohmann::ordered_json::array();
  for (const model::HandDof& dof : hand.model.dofs())
    document["dofs"].push_back(
        {{"name", dof.name}, {"closing", dof.closing}, {"lower", dof.lower}, {"upper", dof.upper}});
  document["fingertips"] = nlohmann::ordered_json::array();
  for (const model::HandFingertip& tip : hand.model.fingertips())
    document["fingertips"].push_back(
        {{"name", tip.name},
         {"link", hand.model.links()[static_cast<std::size_t>(tip.link)].name},
         {"position_m", std::vector<double>(tip.p_LT.begin(), tip.p_LT.end())}});
  document["changes"] = hand.changes;
  document["findings"] = nlohmann::ordered_json::array();
  document["self_collision"] = nlohmann::ordered_json::array();
  for (const UrdfFinding& finding : hand.findings)
    document[finding.code == "self-collision" ? "self_collision" : "findings"].push_back(
        to_json(finding));
  const Span span = fingertip_span(hand.model);
  document["fingertip_span_m"] = {span.least, span.greatest};
  document["opening_m"] = hand.model.reach().opening;
  document["opposed"] = hand.opposed;
  document["trial_grasps"] = nlohmann::ordered_json::array();
  for (const grasping::Body& body : trial_bodies(bodies, hand.model.reach().opening))
    document["trial_grasps"].push_back(trial(hand, body, arguments.candidates, shown));
  return document;
}

/// What other commands call the hand: by its name, if that leads to its folder.
std::string called(const std::string& name, const std::string& folder) {
  std::error_code none;
  if (std::filesystem::equivalent(model::hand_directory(name), folder, none)) return name;
  return folder.find('/') == std::string::npos ? "./" + folder : folder;
}

void print(const nlohmann::ordered_json& document) {
  for (const auto& change : document["changes"]) to_terminal("{}\n", change.get<std::string>());
  to_terminal("\n{:<24} {:>7}\n", "DoF", "closing");
  for (const auto& dof : document["dofs"])
    to_terminal("{:<24} {:>7}\n", dof["name"].get<std::string>(), dof["closing"].get<int>());
  to_terminal("\n{} fingertips, {:.0f} to {:.0f} mm apart; takes objects up to {:.0f} mm\n",
              document["fingertips"].size(), 1e3 * document["fingertip_span_m"][0].get<double>(),
              1e3 * document["fingertip_span_m"][1].get<double>(),
              1e3 * document["opening_m"].get<double>());
  for (const auto& pair : document["self_collision"])
    to_terminal("self-collision at rest: {} {}\n", pair["element"].get<std::string>(),
                pair["what"].get<std::string>());
  if (document["self_collision"].empty()) to_terminal("no self-collision at rest\n");
  for (const auto& trial : document["trial_grasps"])
    to_terminal("{:<12} ({:.0f} mm) {}\n", trial["object"].get<std::string>(),
                1e3 * trial["width_m"].get<double>(),
                trial["held"].get<bool>()
                    ? fmt::format("held, epsilon {:.3f}", trial["epsilon"].get<double>())
                    : "not held: " + trial["reason"].get<std::string>());
  const auto folder = document["folder"].get<std::string>();
  to_terminal(
      "\nthe hand is in {0}; correct hand.toml there where {0}/hand.html shows a wrong guess\n",
      folder);
  const std::string hand = called(document["name"].get<std::string>(), folder);
  to_terminal("then: prehend demo --hand {}\n", hand);
}

/// FINGER=LINK: the finger with this link follows that of a person.
Expected<void> note_fingers(Robot& robot, const std::vector<std::string>& fingers) {
  for (const std::string& told : fingers) {
    const std::size_t equals = told.find('=');
    const auto finger = model::finger_from_string(told.substr(0, equals));
    if (equals == std::string::npos || !finger)
      return fail("is not FINGER=LINK", "--fingers " + told,
                  "fingers are thumb, index, middle, ring and little");
    if (!robot.find_link(told.substr(equals + 1)))
      return fail("there is no such link", "--fingers " + told, "name a link of the file");
    robot.human[told.substr(equals + 1)] = *finger;
  }
  return {};
}

/// Who was told a link beside the fingers would wait for a finger that nobody leads.
Expected<void> check_fingers(const model::HandModel& hand,
                             const std::vector<std::string>& fingers) {
  for (const std::string& told : fingers) {
    const auto finger = model::finger_from_string(told.substr(0, told.find('=')));
    if (std::ranges::none_of(hand.fingertips(),
                             [&](const auto& tip) { return tip.human == finger; }))
      return fail("is no part of a finger of its own", "--fingers " + told,
                  "name a link between palm and fingertip, another for each finger");
  }
  return {};
}

int run_add(AddArguments arguments) {
  for (const char c : arguments.name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_' && c != '-')
      return tool::complain({"a name has letters, digits, _ and - only", arguments.name, {}},
                            exit_wrong_use);
  if (arguments.output.empty()) arguments.output = "./" + arguments.name;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(arguments.file, ignored))
    return tool::complain({"there is no such file", arguments.file, {}}, exit_wrong_use);
  if (std::filesystem::exists(std::filesystem::path(arguments.output) / "hand.urdf", ignored))
    return tool::complain(
        {"there is a hand already", arguments.output, "remove it, or use --output"},
        exit_wrong_use);
  auto robot = read_robot_file(arguments.file, arguments.options);
  if (!robot) return tool::complain(robot.error(), exit_no);
  if (const auto told = note_fingers(*robot, arguments.fingers); !told)
    return tool::complain(told.error(), exit_wrong_use);
  *robot = hand_of(std::move(*robot), arguments.palm);
  const auto hand =
      make_hand(*robot, arguments.name, mesh_files(arguments.file, arguments.options.packages),
                {.trials = true});
  if (!hand) {
    log::error("{}: {}; `prehend hand check` lists everything", arguments.file,
               hand.error().message());
    return 1;
  }
  if (const auto led = check_fingers(hand->model, arguments.fingers); !led)
    return tool::complain(led.error(), exit_wrong_use);
  const auto bodies = planner::catalogue_bodies(arguments.catalogue);
  if (!bodies) return tool::complain(bodies.error(), exit_broken);
  if (const auto written = write_folder(*hand, arguments.output); !written)
    return tool::complain(written.error(), exit_broken);
  std::vector<Trial> trials;
  const nlohmann::ordered_json document = report(*hand, *bodies, arguments, trials);
  if (const auto page = write_page(arguments.output, hand->model, trials, document); !page)
    return tool::complain(page.error(), exit_broken);
  if (arguments.json)
    std::cout << document.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << "\n";
  else
    print(document);
  return 0;
}

}  // namespace

void add_add(tool::Program& program) {
  auto arguments = std::make_shared<AddArguments>();
  CLI::App* command = program.app().add_subcommand(
      "add",
      "Makes a hand of the lab from a URDF, a folder with hand.urdf and hand.toml, and tries it "
      "on\n"
      "three objects. Exit code 0: made, 1: the URDF is not usable, 2: wrong use.");
  command->add_option("FILE", arguments->file, "a URDF, xacro or MJCF")->required();
  command->add_option("--name", arguments->name, "of the hand")->required();
  command->add_option("--output,-o", arguments->output, "folder for the hand (./NAME)");
  command->add_option("--palm", arguments->palm,
                      "the link where the hand begins, of a robot with several or with an arm");
  command
      ->add_option(
          "--fingers", arguments->fingers,
          "FINGER=LINK,…: which human fingers (thumb, index, …) lead those with these links")
      ->delimiter(',');
  command
      ->add_option("--candidates", arguments->candidates,
                   "grasps tried an object, up to four times with few DoFs")
      ->capture_default_str()
      ->check(CLI::Range(1, 100000));
  arguments->catalogue.add_to(*command);
  command->add_flag("--json", arguments->json, "one JSON document on standard output");
  add_file_options(*command, arguments->options);
  program.on(*command, [arguments] { return run_add(*arguments); });
}

}  // namespace prehend::planner
