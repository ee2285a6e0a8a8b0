// `prehend objects evaluate`.
#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <prehend/base/log.hpp>
#include <prehend/recognition_learning/dataset.hpp>
#include <prehend/recognition_learning/model_file.hpp>

#include "tool.hpp"

namespace prehend::recognition {
namespace {

using Json = nlohmann::ordered_json;

struct EvaluateArguments {
  std::string folder, model;
  double accept = 0.5;
  bool json = false, nearest_view = false;
};

int broken(const Error& error) {
  log::error("{}", error.message());
  return 3;
}

struct Tally {
  int count = 0, correct = 0;
};

int evaluate(const EvaluateArguments& arguments) {
  const auto models = load_models(arguments.model);
  if (!models) return broken(models.error());
  const auto folders = class_folders(arguments.folder);
  if (!folders) return broken(folders.error());
  std::vector<std::pair<std::string, Tally>> classes;
  int accepted = 0, accepted_correct = 0;
  Tally all;
  for (const ClassFolder& folder : *folders) {
    Tally tally;
    for (const auto& file : folder.files) {
      const auto view = load_view(file);
      if (!view) {
        log::warning("left out: {}", view.error().message());
        continue;
      }
      const Classification seen =
          classify(*models, describe(*models, models->palette.quantise(view->picture), view->mask),
                   !arguments.nearest_view);
      const bool right = seen.best >= 0 &&
                         models->classes[static_cast<std::size_t>(seen.best)].name == folder.name;
      ++tally.count;
      tally.correct += right;
      if (seen.probability >= arguments.accept) {
        ++accepted;
        accepted_correct += right;
      }
    }
    all.count += tally.count;
    all.correct += tally.correct;
    classes.push_back({folder.name, tally});
  }
  if (all.count == 0) return broken({"no picture could be read", arguments.folder, ""});
  const double accuracy = static_cast<double>(all.correct) / all.count;
  const double share = static_cast<double>(accepted) / all.count;
  const double accuracy_accepted =
      accepted > 0 ? static_cast<double>(accepted_correct) / accepted : 0;
  if (arguments.json) {
    Json table = Json::object();
    for (const auto& [name, tally] : classes)
      table[name] = {{"count", tally.count}, {"correct", tally.correct}};
    std::cout << Json{{"count", all.count},
                      {"accuracy", accuracy},
                      {"accepted", share},
                      {"accuracy_accepted", accuracy_accepted},
                      {"classes", table}}
              << "\n";
    return 0;
  }
  for (const auto& [name, tally] : classes)
    fmt::print("{:32} {:4} of {:4}\n", name, tally.correct, tally.count);
  fmt::print("right {:.1f} % of {}; accepted {:.1f} %, of these right {:.1f} %\n", 100 * accuracy,
             all.count, 100 * share, 100 * accuracy_accepted);
  return 0;
}

}  // namespace

void add_evaluate(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<EvaluateArguments>();
  CLI::App* command =
      app.add_subcommand("evaluate", "How often pictures in a folder a class are named rightly.");
  command->add_option("folder", arguments->folder, "holds a folder a class")->required();
  command->add_option("--model", arguments->model, "trained models")->required();
  command->add_option("--accept", arguments->accept, "least probability of an accepted answer");
  command->add_flag("--nearest-view", arguments->nearest_view,
                    "by the nearest view instead of the learned classifier");
  command->add_flag("--json", arguments->json, "one JSON document");
  command->callback([arguments, &exit_code] { exit_code = evaluate(*arguments); });
}

}  // namespace prehend::recognition
