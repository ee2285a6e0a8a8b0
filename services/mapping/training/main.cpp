// prehend-train: makes the mapping model of a hand.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <prehend/base/log.hpp>
#include <prehend/base/paths.hpp>
#include <prehend/base/progress.hpp>
#include <prehend/base/workers.hpp>

#include "closures.hpp"
#include "teach.hpp"
#include "trainer.hpp"

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

int refuse(const Error& error) {
  log::error("{}", error.message());
  return 3;
}

/// Adds the pairs of a file to a set for the same hand.
Expected<void> add_taught(learning::TrainingSet& set, const std::string& file) {
  auto more = learning::load_training_set(file);
  if (!more) return fail(more.error().what, file, more.error().mend);
  if (more->hand != set.hand || more->dof_names != set.dof_names)
    return fail(fmt::format("is for the hand «{}», not for «{}»", more->hand, set.hand), file);
  if (auto ok = check_consistent(*more); !ok)
    return fail(ok.error().what, file + ", " + ok.error().where, ok.error().mend);
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

}  // namespace

int main(int argc, char** argv) {
  log::set_name("train");
  const auto share = share_directory();
  std::string hand_name = "barrett", scheme_name, catalogue_file, grasps_file, out, set_file;
  std::vector<std::string> taught;
  SetOptions people;
  TrainerOptions trainer;
  bool json = false, close_again = false;
  CLI::App app{"Trains the mapping from human hands to a robot hand"};
  app.add_option("--hand", hand_name, "kind of robot hand")->capture_default_str();
  app.add_option("--scheme", scheme_name,
                 "posture pairs: a name in schemes/ or a file; default: HAND");
  app.add_option("--catalogue", catalogue_file, "objects to grasp; default: the lab's");
  app.add_option("--grasps", grasps_file,
                 "the robot's grasps: read, or made if missing; default: trained/HAND.grasps");
  app.add_flag("--close", close_again, "close the hand again, though the file is there");
  app.add_option("--out", out, "model to write; default: trained/HAND.mapping");
  app.add_option("--training-set", set_file, "also write the training set there");
  app.add_option("--set", taught, "also learn from these sets, of prehend teach; repeatable");
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
  app.add_flag("--json", json, "print the outcome as one JSON document");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (scheme_name.empty()) scheme_name = hand_name;
  if (catalogue_file.empty()) catalogue_file = share / "models" / "objects" / "catalogue.toml";
  if (grasps_file.empty()) grasps_file = share / "trained" / (hand_name + ".grasps");
  if (out.empty()) out = share / "trained" / (hand_name + ".mapping");

  const auto begin = std::chrono::steady_clock::now();
  const auto since_begin = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  const auto hand = model::HandModel::load(share / "models" / "hands" / hand_name);
  if (!hand) return refuse(hand.error());
  const auto scheme = Scheme::load(scheme_path(scheme_name), *hand);
  if (!scheme) return refuse(scheme.error());
  const auto grasps = !close_again && std::filesystem::exists(grasps_file)
                          ? load_robot_grasps(grasps_file, *hand)
                          : close_and_save(*hand, *scheme, catalogue_file, grasps_file);
  if (!grasps) return refuse(grasps.error());

  nlohmann::json document{{"hand", hand_name}, {"scheme", scheme->name}};
  for (const RobotGrasp& grasp : *grasps) document["grasps"].push_back(describe(grasp));
  Sets sets;
  trainer.network.seed = static_cast<std::uint32_t>(people.seed);
  SetOptions others = people;
  others.users = 3;
  others.grasps = static_cast<int>(grasps->size());
  sets.training = demonstrate(*hand, *scheme, *grasps, people);
  others.seed = people.seed + 1;
  sets.validation = demonstrate(*hand, *scheme, *grasps, others);
  others.seed = people.seed + 2;
  others.users = 30;
  sets.test = demonstrate(*hand, *scheme, *grasps, others);
  for (const std::string& file : taught)
    if (auto added = add_taught(sets.training, file); !added) return refuse(added.error());
  if (!set_file.empty())
    if (auto saved = learning::save(set_file, sets.training); !saved) return refuse(saved.error());
  const auto catalogue = model::Catalogue::load(catalogue_file);
  if (!catalogue) return refuse(catalogue.error());
  trainer.precision = precision_discriminant(*catalogue, hand->reach(), people);
  trainer.places = learnt_places(*grasps);
  Steps steps;
  const double before = since_begin();
  const auto model = train_mapping(
      *hand, *scheme, sets, trainer,
      [](std::size_t count, const auto& work) { share_work(count, 0, work, [](std::size_t) {}); },
      std::ref(steps));
  if (!model) return refuse(model.error());
  document["training_seconds"] = since_begin() - before;
  if (auto saved = model->save(out, *hand); !saved) return refuse(saved.error());
  document["model"] = out;
  document["pairs"] = sets.training.pairs.size();
  document["training_set"] = model->traits().training_set_digest;
  for (const MappingNetwork& network : model->networks())
    document["networks"].push_back(describe(*model, network, sets.test));
  document["seconds"] = since_begin();
  if (json) {
    std::cout << document.dump(2) << '\n';
    return 0;
  }
  for (const auto& grasp : document["grasps"])
    log::info("{} {}: epsilon {:.3f}, {}", grasp["object"].get<std::string>(),
              grasp["type"].get<std::string>(), grasp["epsilon"].get<double>(),
              grasp["held"].get<bool>() ? "held" : "not held");
  for (const auto& network : document["networks"])
    log::info("{}: error {:.4f} rad² trained, {:.4f} on other people",
              network["network"].get<std::string>(), network["training_error"].get<double>(),
              network["test_error"].get<double>());
  log::info("{} pairs, {}", document["pairs"].get<std::size_t>(), out);
  log::info("{:.1f} s", document["seconds"].get<double>());
  return 0;
}
