// prehend-train: makes the mapping model of a hand.
#include "services/mapping/tools/train/train_command.hpp"

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/base/log.hpp"
#include "common/base/paths.hpp"
#include "common/base/progress.hpp"
#include "common/base/workers.hpp"
#include "common/service/catalogue_argument.hpp"
#include "common/tool/program.hpp"
#include "services/mapping/files/mapping_model_file.hpp"
#include "services/mapping/files/model_places.hpp"
#include "services/mapping/tools/training/derived_scheme.hpp"
#include "services/mapping/tools/training/first_use.hpp"
#include "services/mapping/tools/training/training_run.hpp"

namespace prehend::mapping {
namespace {

/// A step of training, shown in thousandths.
class Steps {
 public:
  void operator()(std::string_view step, double share) {
    if (step != step_) progress_.emplace(step_ = step);
    progress_->show(static_cast<std::size_t>(1000 * share), 1000);
  }

 private:
  std::string step_;
  std::optional<prehend::Progress> progress_;
};

nlohmann::json describe(const RobotGrasp& grasp) {
  return {{"object", grasp.object},
          {"type", to_string(grasp.type)},
          {"dof", std::vector<double>(grasp.dof.begin(), grasp.dof.end())},
          {"epsilon", grasp.epsilon},
          {"held", grasp.held}};
}

nlohmann::json describe(const MappingModel& model, const MappingNetwork& network,
                        const learning::TrainingSet& test) {
  const bool direct = network.shape == model::ShapeKind::unknown;
  nlohmann::json entry{{"network", direct ? "direct" : model::to_string(network.shape)},
                       {"training_error", network.errors.training},
                       {"validation_error", network.errors.validation},
                       {"test_error", network.errors.test}};
  if (direct) return entry;
  const Comparison all = compare(model, test, network.shape, false);
  const Comparison grasps = compare(model, test, network.shape, true);
  entry["test_error_of_direct"] = all.direct;
  entry["grasp_test_error"] = grasps.intelligent;
  entry["grasp_test_error_of_direct"] = grasps.direct;
  return entry;
}

struct Arguments {
  service::CatalogueArgument catalogue;
  std::string hand = model::lab_hand(), scheme, grasps, out, set_file;
  std::string made_for;  // see ModelPlaces
  std::vector<std::string> taught;
  SetOptions people;
  TrainerOptions trainer;
  bool json = false, close_again = false, if_needed = false;
};

void add_people(CLI::App& app, SetOptions& people) {
  app.add_option("--users", people.users, "synthetic people to learn from; 0: only from --set")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  app.add_option("--takes", people.takes, "takes of each")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  app.add_option("--postures", people.postures, "basic postures: 4, 7, 10 or 13")
      ->check(CLI::IsMember({4, 7, 10, 13}))
      ->capture_default_str();
  app.add_option("--seed", people.seed, "of people and first weights")->capture_default_str();
}

void add_trainer(CLI::App& app, TrainerOptions& trainer) {
  app.add_option("--hidden", trainer.network.hidden, "neurons in the hidden layer")
      ->check(CLI::Range(1, 200))
      ->capture_default_str();
  app.add_option_function<std::string>(
      "--size",
      [&](const std::string& name) {
        const auto input = size_input_from_string(name);
        if (!input) throw CLI::ValidationError("--size", "characteristic, dimensions, seen");
        trainer.size_input = *input;
      },
      "what intelligent networks are told of the object; default: seen");
  app.add_option_function<std::string>(
      "--method",
      [&](const std::string& name) {
        const auto method = learning::method_from_string(name);
        if (!method)
          throw CLI::ValidationError("--method",
                                     "incremental, batch, rprop, quickprop, sarprop, cascade");
        trainer.network.method = *method;
      },
      "how to train; default: rprop");
}

void add_files(CLI::App& app, Arguments& arguments) {
  app.add_option("--hand", arguments.hand, "kind of robot hand: a name, or a folder")
      ->capture_default_str();
  app.add_option(
      "--scheme", arguments.scheme,
      "posture pairs: a name in schemes/ or a file; default: the hand's, else derived from "
      "how it moves");
  arguments.catalogue.add_to(app);
  app.add_option(
      "--grasps", arguments.grasps,
      "the robot's grasps: read, or made if missing; default: beside the model, HAND.grasps");
  app.add_flag("--close", arguments.close_again, "close the hand again, though the file is there");
  app.add_option("--out", arguments.out,
                 "model to write; default: where the mapping looks for that of the hand");
  app.add_option("--training-set", arguments.set_file, "also write the training set there");
  app.add_option("--set", arguments.taught,
                 "also learn from these sets, of prehend teach; repeatable");
}

void fill_in_defaults(Arguments& arguments) {
  const ModelPlaces places = model_places(arguments.hand);
  if (arguments.grasps.empty()) {
    arguments.grasps = places.grasps;
    arguments.made_for = places.made_for;
  }
  if (arguments.out.empty()) arguments.out = places.model;
}

void print(const nlohmann::json& document) {
  for (const auto& grasp : document["grasps"])
    log::info("{} {}: epsilon {:.3f}, {}", grasp["object"].get<std::string>(),
              grasp["type"].get<std::string>(), grasp["epsilon"].get<double>(),
              grasp["held"].get<bool>() ? "held" : "not held");
  for (const auto& network : document["networks"])
    log::info("{}: error {:.4f} rad² trained, {:.4f} on other people",
              network["network"].get<std::string>(), network["training_error"].get<double>(),
              network["test_error"].get<double>());
  log::info("{} pairs, {}", document["pairs"].get<std::size_t>(),
            document["model"].get<std::string>());
  log::info("{:.1f} s", document["seconds"].get<double>());
}

/// Trains and saves the model; says what came of it.
Expected<nlohmann::json> train(const Arguments& arguments) {
  const auto begin = std::chrono::steady_clock::now();
  const auto since_begin = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  const auto hand = model::HandModel::load(model::hand_directory(arguments.hand));
  if (!hand) return tl::unexpected(hand.error());
  const auto scheme = arguments.scheme.empty()
                          ? load_or_derive(model_places(arguments.hand).scheme, *hand)
                          : Scheme::load(scheme_path(arguments.scheme), *hand);
  if (!scheme) return tl::unexpected(scheme.error());
  const auto catalogue = arguments.catalogue.path();
  if (!catalogue) return tl::unexpected(catalogue.error());
  const TrainingRun run{.catalogue = *catalogue,
                        .grasps = arguments.grasps,
                        .close_again = arguments.close_again,
                        .closures = {.made_for = arguments.made_for},
                        .people = arguments.people,
                        .trainer = arguments.trainer,
                        .taught = {arguments.taught.begin(), arguments.taught.end()},
                        .set_file = arguments.set_file};
  Steps steps;
  double before = 0;
  const auto trained = run_training(
      run, *hand, *scheme,
      [&](std::size_t count, const auto& work) {
        before = since_begin();
        share_work(count, 0, work, [](std::size_t) {});
      },
      std::ref(steps));
  if (!trained) return tl::unexpected(trained.error());
  nlohmann::json document{{"hand", arguments.hand}, {"scheme", scheme->name}};
  for (const RobotGrasp& grasp : trained->grasps) document["grasps"].push_back(describe(grasp));
  document["training_seconds"] = since_begin() - before;
  if (auto saved = save_mapping_model(arguments.out, trained->model, *hand); !saved)
    return tl::unexpected(saved.error());
  document["model"] = arguments.out;
  document["pairs"] = trained->sets.training.pairs.size();
  document["training_set"] = trained->model.traits().training_set_digest;
  for (const MappingNetwork& network : trained->model.networks())
    document["networks"].push_back(describe(trained->model, network, trained->sets.test));
  document["seconds"] = since_begin();
  return document;
}

/// Nothing where there is a model that fits the hand as it is now.
Expected<nlohmann::json> train_if_needed(const std::string& name) {
  const auto hand = model::HandModel::load(model::hand_directory(name));
  if (!hand) return tl::unexpected(hand.error());
  const auto places = ready_places(name, *hand, Needs::model);
  if (!places) return tl::unexpected(places.error());
  return nlohmann::json{{"hand", name}, {"model", places->model.string()}};
}

int answer(const Expected<nlohmann::json>& document, bool json, bool told) {
  if (!document) return tool::complain(document.error(), exit_broken);
  if (json)
    std::cout << document->dump(2) << '\n';
  else if (!told)
    print(*document);
  return exit_done;
}

}  // namespace

int train_command(const std::vector<std::string>& texts) {
  log::set_name("train");
  Arguments arguments;
  CLI::App app{"Trains the mapping from human hands to a robot hand"};
  add_files(app, arguments);
  add_people(app, arguments.people);
  add_trainer(app, arguments.trainer);
  app.add_flag("--json", arguments.json, "print the outcome as one JSON document");
  app.add_flag("--if-needed", arguments.if_needed,
               "only if there is no model of the hand as it is now, and in seconds: what others do "
               "on first use; of the other options only --hand counts");
  if (const auto code = tool::parse(app, texts)) return *code;
  if (arguments.if_needed) return answer(train_if_needed(arguments.hand), arguments.json, true);
  fill_in_defaults(arguments);
  return answer(train(arguments), arguments.json, false);
}

}  // namespace prehend::mapping
