// prehend-train: makes the mapping model of a hand.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <prehend/base/log.hpp>
#include <prehend/base/paths.hpp>

#include "trainer.hpp"

namespace {

using namespace prehend;
using namespace prehend::mapping;

/// On a terminal a bar that fills, else a line when a step is done. On standard error.
class ProgressShown {
 public:
  void operator()(std::string_view step, double share) {
    if (step == done_) return;
    if (share >= 1) done_ = step;
    if (terminal_) {
      constexpr int width = 30;
      const int filled = static_cast<int>(share * width);
      std::fprintf(stderr, "\r%-18.*s [%.*s%*s] %3.0f %%", static_cast<int>(step.size()),
                   step.data(), filled, "##############################", width - filled, "",
                   100 * share);
      if (share >= 1) std::fputc('\n', stderr);
    } else if (share >= 1) {
      log::info("{}: done", step);
    }
  }

 private:
  std::string done_;  // the last step that was finished
  bool terminal_ = isatty(STDERR_FILENO) == 1;
};

int refuse(const Error& error) {
  log::error("{}", error.message());
  return 3;
}

}  // namespace

int main(int argc, char** argv) {
  log::set_name("train");
  const auto share = share_directory();
  std::string hand_name = "barrett", scheme_file, catalogue_file, out, set_file;
  SetOptions people;
  TrainerOptions trainer;
  bool json = false;
  CLI::App app{"Trains the mapping from human hands to a robot hand"};
  app.add_option("--hand", hand_name, "kind of robot hand")->capture_default_str();
  app.add_option("--scheme", scheme_file, "posture pairs; default: schemes/HAND.toml");
  app.add_option("--catalogue", catalogue_file, "objects to grasp; default: the lab's");
  app.add_option("--out", out, "model to write; default: trained/HAND.mapping");
  app.add_option("--training-set", set_file, "also write the training set there");
  app.add_option("--users", people.users, "synthetic people to learn from")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--takes", people.takes, "takes of each")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  app.add_option("--seed", people.seed, "of people and first weights")->capture_default_str();
  app.add_option("--hidden", trainer.network.hidden, "neurons in the hidden layer")
      ->check(CLI::Range(1, 200))
      ->capture_default_str();
  app.add_option_function<std::string>(
      "--method",
      [&](const std::string& name) {
        const auto method = learning::method_from_string(name);
        if (!method)
          throw CLI::ValidationError("--method", "incremental, batch, rprop, quickprop, sarprop");
        trainer.network.method = *method;
      },
      "how to train; default: rprop");
  app.add_flag("--json", json, "print the outcome as one JSON document");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (scheme_file.empty()) scheme_file = share / "schemes" / (hand_name + ".toml");
  if (catalogue_file.empty()) catalogue_file = share / "models" / "objects" / "catalogue.toml";
  if (out.empty()) out = share / "trained" / (hand_name + ".mapping");

  const auto begin = std::chrono::steady_clock::now();
  const auto hand = model::HandModel::load(share / "models" / "hands" / hand_name);
  if (!hand) return refuse(hand.error());
  const auto scheme = Scheme::load(scheme_file, *hand);
  if (!scheme) return refuse(scheme.error());
  const auto catalogue = model::Catalogue::load(catalogue_file);
  if (!catalogue) return refuse(catalogue.error());

  ProgressShown shown;
  const auto grasps = close_on_catalogue(*hand, *scheme, *catalogue, std::ref(shown),
                                         [](const Error& e) { log::warning("{}", e.message()); });
  if (grasps.empty()) return refuse({"the hand can grasp nothing of it", catalogue_file, ""});
  Sets sets;
  trainer.network.seed = static_cast<std::uint32_t>(people.seed);
  SetOptions others = people;
  others.users = 3;
  sets.training = demonstrate(*hand, *scheme, grasps, people);
  others.seed = people.seed + 1;
  sets.validation = demonstrate(*hand, *scheme, grasps, others);
  others.seed = people.seed + 2;
  sets.test = demonstrate(*hand, *scheme, grasps, others);
  if (!set_file.empty())
    if (auto saved = learning::save(set_file, sets.training); !saved) return refuse(saved.error());
  const auto model = train_mapping(*hand, sets, trainer, std::ref(shown));
  if (!model) return refuse(model.error());
  if (auto saved = model->save(out, *hand); !saved) return refuse(saved.error());

  const double took =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  nlohmann::json document{{"hand", hand_name},
                          {"scheme", scheme->name},
                          {"model", out},
                          {"pairs", sets.training.pairs.size()},
                          {"training_set", model->training_set_digest()},
                          {"seconds", took}};
  for (const RobotGrasp& grasp : grasps)
    document["grasps"].push_back({{"object", grasp.object},
                                  {"type", grasp.type},
                                  {"dof", std::vector<double>(grasp.dof.begin(), grasp.dof.end())},
                                  {"epsilon", grasp.epsilon},
                                  {"held", grasp.held}});
  for (const MappingNetwork& network : model->networks()) {
    const bool direct = network.shape == model::ShapeKind::unknown;
    nlohmann::json entry{{"network", direct ? "direct" : model::to_string(network.shape)},
                         {"training_error", network.errors.training},
                         {"validation_error", network.errors.validation},
                         {"test_error", network.errors.test}};
    if (!direct) {
      const Comparison c = compare(*model, sets.test, network.shape, true);
      entry["grasp_test_error"] = c.intelligent;
      entry["grasp_test_error_of_direct"] = c.direct;
    }
    document["networks"].push_back(entry);
  }
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
  log::info("{} pairs, {:.1f} s, {}", sets.training.pairs.size(), took, out);
  return 0;
}
