// prehend-train: makes the mapping model of a hand.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/base/log.hpp"
#include "common/base/paths.hpp"
#include "common/base/progress.hpp"
#include "common/base/workers.hpp"
#include "common/tool/program.hpp"
#include "services/mapping/files/mapping_model_file.hpp"
#include "services/mapping/tools/training/closures.hpp"
#include "services/mapping/tools/training/teach.hpp"
#include "services/mapping/tools/training/trainer.hpp"

namespace {

using namespace prehend;
using namespace prehend::mapping;

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

/// Adds the pairs of a file to a set for the same hand.
Expected<void> add_taught(learning::TrainingSet& set, const std::string& file) {
  auto more = learning::load_training_set(file);
  if (!more) return fail(more.error().what, file, more.error().hint);
  if (more->hand != set.hand || more->dof_names != set.dof_names)
    return fail(fmt::format("is for the hand «{}», not for «{}»", more->hand, set.hand), file);
  if (auto ok = check_consistent(*more); !ok)
    return fail(ok.error().what, file + ", " + ok.error().where, ok.error().hint);
  // Repeated until they are a tenth of all: few pairs of one person would be lost among the others.
  const std::size_t times = std::max<std::size_t>(1, set.pairs.size() / more->pairs.size() / 10);
  for (std::size_t i = 0; i < times; ++i)
    set.pairs.insert(set.pairs.end(), more->pairs.begin(), more->pairs.end());
  return {};
}

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
  std::filesystem::path share = share_directory();
  std::string hand = model::lab_hand(), scheme, catalogue, grasps, out, set_file;
  std::vector<std::string> taught;
  SetOptions people;
  TrainerOptions trainer;
  bool json = false, close_again = false;
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
  app.add_option("--hand", arguments.hand, "kind of robot hand")->capture_default_str();
  app.add_option("--scheme", arguments.scheme,
                 "posture pairs: a name in schemes/ or a file; default: HAND");
  app.add_option("--catalogue", arguments.catalogue, "objects to grasp; default: the lab's");
  app.add_option("--grasps", arguments.grasps,
                 "the robot's grasps: read, or made if missing; default: trained/HAND.grasps");
  app.add_flag("--close", arguments.close_again, "close the hand again, though the file is there");
  app.add_option("--out", arguments.out, "model to write; default: trained/HAND.mapping");
  app.add_option("--training-set", arguments.set_file, "also write the training set there");
  app.add_option("--set", arguments.taught,
                 "also learn from these sets, of prehend teach; repeatable");
}

void fill_in_defaults(Arguments& arguments) {
  const auto& share = arguments.share;
  if (arguments.scheme.empty()) arguments.scheme = arguments.hand;
  if (arguments.catalogue.empty())
    arguments.catalogue = share / "models" / "objects" / "catalogue.toml";
  if (arguments.grasps.empty()) arguments.grasps = share / "trained" / (arguments.hand + ".grasps");
  if (arguments.out.empty()) arguments.out = share / "trained" / (arguments.hand + ".mapping");
}

/// What to learn from, what ends the training, and other people to judge the model by.
Expected<Sets> make_sets(const Arguments& arguments, const model::HandModel& hand,
                         const Scheme& scheme, const std::vector<RobotGrasp>& grasps) {
  Sets sets;
  SetOptions others = arguments.people;
  others.users = 3;
  others.grasps = static_cast<int>(grasps.size());
  sets.training = demonstrate(hand, scheme, grasps, arguments.people);
  others.seed = arguments.people.seed + 1;
  sets.validation = demonstrate(hand, scheme, grasps, others);
  others.seed = arguments.people.seed + 2;
  others.users = 30;
  sets.test = demonstrate(hand, scheme, grasps, others);
  for (const std::string& file : arguments.taught)
    if (auto added = add_taught(sets.training, file); !added) return tl::unexpected(added.error());
  if (!arguments.set_file.empty())
    if (auto saved = learning::save(arguments.set_file, sets.training); !saved)
      return tl::unexpected(saved.error());
  return sets;
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
  const auto hand = model::HandModel::load(arguments.share / "models" / "hands" / arguments.hand);
  if (!hand) return tl::unexpected(hand.error());
  const auto scheme = Scheme::load(scheme_path(arguments.scheme), *hand);
  if (!scheme) return tl::unexpected(scheme.error());
  const auto grasps = !arguments.close_again && std::filesystem::exists(arguments.grasps)
                          ? load_robot_grasps(arguments.grasps, *hand)
                          : close_and_save(*hand, *scheme, arguments.catalogue, arguments.grasps);
  if (!grasps) return tl::unexpected(grasps.error());
  const auto sets = make_sets(arguments, *hand, *scheme, *grasps);
  if (!sets) return tl::unexpected(sets.error());
  const auto catalogue = model::Catalogue::load(arguments.catalogue);
  if (!catalogue) return tl::unexpected(catalogue.error());

  TrainerOptions trainer = arguments.trainer;
  trainer.network.seed = static_cast<std::uint32_t>(arguments.people.seed);
  trainer.precision = precision_discriminant(*catalogue, hand->reach(), arguments.people);
  trainer.places = learnt_places(*grasps);
  Steps steps;
  const double before = since_begin();
  const auto model = train_mapping(
      *hand, *scheme, *sets, trainer,
      [](std::size_t count, const auto& work) { share_work(count, 0, work, [](std::size_t) {}); },
      std::ref(steps));
  if (!model) return tl::unexpected(model.error());
  nlohmann::json document{{"hand", arguments.hand}, {"scheme", scheme->name}};
  for (const RobotGrasp& grasp : *grasps) document["grasps"].push_back(describe(grasp));
  document["training_seconds"] = since_begin() - before;
  if (auto saved = save_mapping_model(arguments.out, *model, *hand); !saved)
    return tl::unexpected(saved.error());
  document["model"] = arguments.out;
  document["pairs"] = sets->training.pairs.size();
  document["training_set"] = model->traits().training_set_digest;
  for (const MappingNetwork& network : model->networks())
    document["networks"].push_back(describe(*model, network, sets->test));
  document["seconds"] = since_begin();
  return document;
}

}  // namespace

int main(int argc, char** argv) {
  log::set_name("train");
  Arguments arguments;
  CLI::App app{"Trains the mapping from human hands to a robot hand"};
  add_files(app, arguments);
  add_people(app, arguments.people);
  add_trainer(app, arguments.trainer);
  app.add_flag("--json", arguments.json, "print the outcome as one JSON document");
  if (const auto code = tool::parse(app, argc, argv)) return *code;
  fill_in_defaults(arguments);
  const auto document = train(arguments);
  if (!document) return tool::complain(document.error(), exit_broken);
  if (arguments.json)
    std::cout << document->dump(2) << '\n';
  else
    print(*document);
  return 0;
}
