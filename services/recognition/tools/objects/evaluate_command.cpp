// `prehend objects evaluate`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/base/log.hpp"
#include "common/base/log_format.hpp"
#include "common/base/progress.hpp"
#include "common/base/to_terminal.hpp"
#include "common/statistics/intervals.hpp"
#include "services/recognition/core/learning/answer.hpp"
#include "services/recognition/core/learning/folds.hpp"
#include "services/recognition/files/model_file.hpp"
#include "services/recognition/files/picture_file.hpp"
#include "services/recognition/tools/evaluation/report.hpp"
#include "services/recognition/tools/evaluation/trial.hpp"
#include "services/recognition/tools/objects/commands.hpp"
#include "services/recognition/tools/objects/descriptor_choice.hpp"

namespace prehend::recognition {
namespace {

using Json = nlohmann::ordered_json;

struct EvaluateArguments {
  std::string folder, model, training, groups, strangers, report;
  DescriptorChoice choice;
  double accept = 0.5;
  int folds = 5;
  bool json = false, nearest_view = false, compare = false, leave_out = false, other_light = false;
};

Expected<Dataset> read(const std::string& folder) {
  auto dataset = load_dataset(folder);
  if (!dataset) return dataset;
  for (const Error& error : dataset->left_out) log::warning("left out: {}", error.message());
  std::size_t views = 0;
  for (const TrainingClass& c : dataset->classes) views += c.views.size();
  if (views == 0) return fail("no picture could be read", folder, picture_kinds);
  return dataset;
}

/// The pictures, how they are judged, and what came of it.
struct Evaluation {
  const EvaluateArguments& arguments;
  Dataset dataset, strangers;
  std::optional<ObjectModels> models;  // of --model
  std::optional<Dataset> training;     // of --train
  std::vector<int> fold;               // else
  std::vector<std::string> classes;    // as the judged pictures count them
  std::vector<int> number;             // of each class of the dataset among them
};

std::vector<std::string> names_of(const Dataset& dataset) {
  std::vector<std::string> made;
  for (const TrainingClass& c : dataset.classes) made.push_back(c.name);
  return made;
}

Expected<Evaluation> prepare(const EvaluateArguments& arguments) {
  auto dataset = read(arguments.folder);
  if (!dataset) return tl::unexpected(dataset.error());
  Evaluation trial{arguments, std::move(*dataset), {}, {}, {}, {}, {}, {}};
  if (!arguments.strangers.empty()) {
    auto strangers = read(arguments.strangers);
    if (!strangers) return tl::unexpected(strangers.error());
    trial.strangers = std::move(*strangers);
  }
  if (!arguments.model.empty()) {
    auto models = load_models(arguments.model);
    if (!models) return tl::unexpected(models.error());
    for (const ObjectClass& c : models->classes) trial.classes.push_back(c.name);
    trial.models = std::move(*models);
  } else if (!arguments.training.empty()) {
    auto training = read(arguments.training);
    if (!training) return tl::unexpected(training.error());
    trial.classes = names_of(*training);
    trial.training = std::move(*training);
  } else {
    trial.classes = names_of(trial.dataset);
    if (arguments.groups.empty()) {
      trial.fold = folds_by_background(trial.dataset.classes, arguments.folds);
    } else {
      auto fold = folds_from(arguments.groups, trial.dataset);
      if (!fold) return tl::unexpected(fold.error());
      trial.fold = std::move(*fold);
    }
  }
  for (const TrainingClass& c : trial.dataset.classes) {
    const auto known = std::find(trial.classes.begin(), trial.classes.end(), c.name);
    trial.number.push_back(static_cast<int>(known - trial.classes.begin()));
    if (known == trial.classes.end()) trial.classes.push_back(c.name);  // never answered
  }
  return trial;
}

Expected<std::vector<Judged>> judge(const Evaluation& trial, Method method,
                                    const DescriptorOptions& options) {
  Progress progress(std::string(to_string(method)));
  const Told told = [&](std::size_t done, std::size_t all) { progress.show(done, all); };
  if (trial.arguments.leave_out) return leave_classes_out(method, options, trial.dataset, told);
  if (trial.models)
    return judge_all(*recogniser_of(*trial.models, method), trial.dataset, trial.number,
                     trial.strangers, told);
  if (!trial.training)
    return cross_validate(method, options, trial.dataset, trial.fold, trial.strangers,
                          trial.arguments.other_light, told);
  const auto recogniser = make_recogniser(method, options);
  if (const auto learned = recogniser->learn(trial.training->classes); !learned)
    return tl::unexpected(learned.error());
  return judge_all(*recogniser, trial.dataset, trial.number, trial.strangers, told);
}

std::string percent(std::size_t part, std::size_t whole) {
  const statistics::Interval range = statistics::share_interval(part, whole);
  return fmt::format(
      "{:5.1f} % [{:.1f}, {:.1f}]",
      whole == 0 ? 0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole),
      100 * range.low, 100 * range.high);
}

double ratio(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

std::size_t right_of(const std::vector<Judged>& pictures) {
  return static_cast<std::size_t>(
      std::count_if(pictures.begin(), pictures.end(), [](const Judged& p) { return p.right(); }));
}

Json interval_json(std::size_t part, std::size_t whole) {
  const statistics::Interval range = statistics::share_interval(part, whole);
  return {range.low, range.high};
}

/// Accuracy, and what a threshold that lets 95 % of the known pictures through does.
Json summary(const std::vector<Judged>& pictures, double accept_at) {
  const std::size_t right = right_of(pictures);
  const Accepted given = accept(pictures, accept_at);
  const double threshold = threshold_for(pictures, 0.95);
  const Accepted at95 = accept(pictures, threshold);
  return {{"count", given.known},
          {"accuracy", ratio(right, given.known)},
          {"accuracy_ci95", interval_json(right, given.known)},
          {"accepted", ratio(given.known_accepted, given.known)},
          {"accuracy_accepted",
           ratio(given.known_accepted - given.wrong_accepted, given.known_accepted)},
          {"at_95_accepted",
           {{"threshold", threshold},
            {"error", ratio(at95.wrong_accepted, at95.known_accepted)},
            {"strangers_rejected", ratio(at95.strangers_rejected, at95.strangers)}}},
          {"strangers", given.strangers},
          {"strangers_rejected", ratio(given.strangers_rejected, given.strangers)},
          {"brier", brier(pictures)}};
}

void print_matrix(const Evaluation& trial, const std::vector<Judged>& pictures) {
  const auto counts = confusion(pictures, trial.classes.size());
  to_terminal("\n{:36}", "is \\ taken for");
  for (std::size_t i = 0; i < trial.classes.size(); ++i) to_terminal("{:4}", i + 1);
  to_terminal("\n");
  for (std::size_t row = 0; row < trial.classes.size(); ++row) {
    to_terminal("{:3} {:32}", row + 1, trial.classes[row]);
    for (const int count : counts[row])
      to_terminal("{:>4}", count == 0 ? "." : std::to_string(count));
    to_terminal("\n");
  }
}

void print_result(const Evaluation& trial, const std::vector<Judged>& pictures) {
  if (!trial.arguments.leave_out) {
    for (std::size_t c = 0; c < trial.dataset.classes.size(); ++c) {
      std::size_t count = 0, right = 0;
      for (const Judged& p : pictures)
        if (p.truth == trial.number[c]) {
          ++count;
          right += p.right();
        }
      to_terminal("{:32} {:4} of {:4}  {}\n", trial.dataset.classes[c].name, right, count,
                  percent(right, count));
    }
    print_matrix(trial, pictures);
    const std::size_t right = right_of(pictures);
    const Accepted given = accept(pictures, trial.arguments.accept);
    to_terminal("\nright {} of {}\n", percent(right, given.known), given.known);
    to_terminal("at probability {:.2f}: accepted {}, of these wrong {}\n", trial.arguments.accept,
                percent(given.known_accepted, given.known),
                percent(given.wrong_accepted, given.known_accepted));
    const double threshold = threshold_for(pictures, 0.95);
    const Accepted at95 = accept(pictures, threshold);
    to_terminal("at probability {:.2f}: accepted {}, of these wrong {}\n", threshold,
                percent(at95.known_accepted, at95.known),
                percent(at95.wrong_accepted, at95.known_accepted));
    if (at95.strangers > 0)
      to_terminal("strangers rejected: {} there, {} at {:.2f}, of {}\n",
                  percent(at95.strangers_rejected, at95.strangers),
                  percent(given.strangers_rejected, given.strangers), trial.arguments.accept,
                  given.strangers);
    return;
  }
  for (const TrainingClass& c : trial.dataset.classes) {
    std::size_t count = 0, rejected = 0;
    const auto number = static_cast<std::size_t>(&c - trial.dataset.classes.data());
    std::vector<int> taken(trial.classes.size(), 0);
    for (const Judged& p : pictures) {
      const auto& files = trial.dataset.files[number];
      if (std::find(files.begin(), files.end(), p.file) == files.end()) continue;
      ++count;
      const bool through = p.best >= 0 && p.probability >= trial.arguments.accept;
      rejected += !through;
      if (through) ++taken[static_cast<std::size_t>(p.best)];
    }
    const auto most = std::max_element(taken.begin(), taken.end());
    to_terminal("{:32} rejected {}{}\n", c.name, percent(rejected, count),
                *most == 0
                    ? ""
                    : fmt::format("; most often taken for {}",
                                  trial.classes[static_cast<std::size_t>(most - taken.begin())]));
  }
  const Accepted given = accept(pictures, trial.arguments.accept);
  to_terminal("look-alikes rejected at {:.2f}: {} of {}\n", trial.arguments.accept,
              percent(given.strangers_rejected, given.strangers), given.strangers);
}

/// How often each verdict was given on a dataset's pictures.
std::map<PhotoVerdict, std::size_t> verdicts(const Evaluation& trial, const Dataset& dataset) {
  std::map<PhotoVerdict, std::size_t> made;
  for (const TrainingClass& c : dataset.classes)
    for (const TrainingView& view : c.views)
      ++made[answer(*trial.models, view.picture, trial.arguments.accept).verdict];
  return made;
}

void print_verdicts(const char* what, const std::map<PhotoVerdict, std::size_t>& given) {
  to_terminal("{}:", what);
  for (const auto& [verdict, count] : given) to_terminal(" {} {}", to_string(verdict), count);
  to_terminal("\n");
}

Json to_json(const std::map<PhotoVerdict, std::size_t>& given) {
  Json made = Json::object();
  for (const auto& [verdict, count] : given) made[std::string(to_string(verdict))] = count;
  return made;
}

int compare(const Evaluation& trial, const DescriptorOptions& options) {
  if (trial.models) {
    log::error("--compare learns anew: name --train DIR or neither");
    return 2;
  }
  Json document = Json::object();
  if (!trial.arguments.json)
    to_terminal(
        "| method | right | error among the surest 95 % | strangers rejected there | Brier |\n"
        "|---|---|---|---|---|\n");
  for (const Method method : {Method::learned, Method::nearest_view, Method::false_alarm,
                              Method::histogram, Method::sift}) {
    const auto pictures = judge(trial, method, options);
    if (!pictures) return broken(pictures.error());
    document[std::string(to_string(method))] = summary(*pictures, trial.arguments.accept);
    if (trial.arguments.json) continue;
    const Accepted at95 = accept(*pictures, threshold_for(*pictures, 0.95));
    to_terminal("| {} | {} | {} | {} | {:.3f} |\n", to_string(method),
                percent(right_of(*pictures), at95.known),
                percent(at95.wrong_accepted, at95.known_accepted),
                at95.strangers == 0 ? "–" : percent(at95.strangers_rejected, at95.strangers),
                brier(*pictures));
    std::fflush(stdout);
  }
  if (trial.arguments.json) std::cout << document << "\n";
  return 0;
}

int evaluate(const EvaluateArguments& arguments) {
  const auto trial = prepare(arguments);
  if (!trial) return broken(trial.error());
  const auto options =
      arguments.choice.options(trial->training ? *trial->training : trial->dataset);
  if (!options) {
    log::error(options.error());
    return 2;
  }
  if (arguments.compare) return compare(*trial, *options);
  const Method method = arguments.nearest_view ? Method::nearest_view : Method::learned;
  const auto pictures = judge(*trial, method, *options);
  if (!pictures) return broken(pictures.error());
  if (!arguments.report.empty()) {
    const auto written =
        write_report(arguments.report, fmt::format("{}: {}", arguments.folder, to_string(method)),
                     trial->classes, *pictures, arguments.accept);
    if (!written) return broken(written.error());
  }
  if (!arguments.json) {
    print_result(*trial, *pictures);
    if (trial->models) {
      print_verdicts("verdicts", verdicts(*trial, trial->dataset));
      if (!arguments.strangers.empty())
        print_verdicts("verdicts on strangers", verdicts(*trial, trial->strangers));
    }
    return 0;
  }
  Json document = summary(*pictures, arguments.accept);
  Json table = Json::object();
  for (std::size_t c = 0; c < trial->dataset.classes.size(); ++c) {
    std::size_t count = 0, right = 0;
    for (const Judged& p : *pictures)
      if (p.truth == trial->number[c]) {
        ++count;
        right += p.right();
      }
    table[trial->dataset.classes[c].name] = {{"count", count}, {"correct", right}};
  }
  document["classes"] = table;
  document["taken_for"] = {{"names", trial->classes},
                           {"counts", confusion(*pictures, trial->classes.size())}};
  if (trial->models) {
    document["verdicts"] = to_json(verdicts(*trial, trial->dataset));
    if (!arguments.strangers.empty())
      document["verdicts_on_strangers"] = to_json(verdicts(*trial, trial->strangers));
  }
  std::cout << document << "\n";
  return 0;
}

}  // namespace

void add_evaluate(tool::Program& program) {
  auto arguments = std::make_shared<EvaluateArguments>();
  CLI::App* command = program.app().add_subcommand(
      "evaluate",
      "How often pictures in a folder a class are named rightly: by trained models, by what is "
      "learned from another folder, or, with neither, in folds that keep pictures before the same "
      "background together.");
  command->add_option("folder", arguments->folder, "holds a folder a class")->required();
  auto* model = command->add_option("--model", arguments->model, "trained models");
  auto* training = command->add_option("--train", arguments->training, "learn from this folder")
                       ->excludes(model);
  command->add_option("--folds", arguments->folds, "by background")
      ->check(CLI::Range(2, 20))
      ->excludes(model)
      ->excludes(training);
  command
      ->add_option("--groups", arguments->groups,
                   "folds from a file instead: lines of CLASS,FIRST,LAST, counted from 0")
      ->excludes(model)
      ->excludes(training);
  command->add_option("--strangers", arguments->strangers,
                      "pictures of other kinds of objects, a folder a kind");
  command
      ->add_flag("--leave-out", arguments->leave_out,
                 "leave each class out and see whether its pictures are rejected")
      ->excludes(model)
      ->excludes(training);
  command
      ->add_flag("--other-light", arguments->other_light,
                 "in folds: name the pictures in other light, size and place than they are in")
      ->excludes(model)
      ->excludes(training);
  command->add_option("--accept", arguments->accept, "least probability of an accepted answer");
  command->add_flag("--nearest-view", arguments->nearest_view,
                    "by the nearest view instead of the learned classifier");
  command->add_flag("--compare", arguments->compare,
                    "beside the nearest view, a colour histogram and SIFT features");
  command->add_option("--report", arguments->report,
                      "folder for index.html with the failures and the reliability diagram");
  arguments->choice.add_to(*command);
  command->add_flag("--json", arguments->json, "one JSON document");
  program.on(*command, [arguments] { return evaluate(*arguments); });
}

}  // namespace prehend::recognition
