// `prehend demonstration evaluate`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "common/base/log.hpp"
#include "common/base/log_format.hpp"
#include "common/base/progress.hpp"
#include "common/base/to_terminal.hpp"
#include "services/demonstration/files/recogniser_file.hpp"
#include "services/demonstration/tools/demonstration/commands.hpp"
#include "services/demonstration/tools/demonstration/takes_argument.hpp"
#include "services/demonstration/tools/evaluation/trial.hpp"

namespace prehend::demonstration {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array coverages{1.0, 0.9, 0.8, 0.5};
constexpr std::array shares{0.25, 0.5, 0.75, 1.0};

struct Arguments {
  std::string folder, training, model, families = "bottle+cup,knife+pen";
  TrainerOptions options;
  unsigned threads = 0;
  bool with_object = false, json = false;
};

std::size_t errors_of(const std::vector<Judged>& grasps) {
  return static_cast<std::size_t>(std::count_if(grasps.begin(), grasps.end(),
                                                [](const Judged& each) { return !each.right(); }));
}

/// Share of the errors that are none any more.
double fewer(const std::vector<Judged>& before, const std::vector<Judged>& after) {
  const auto errors = static_cast<double>(errors_of(before));
  return errors > 0 ? 1 - static_cast<double>(errors_of(after)) / errors : 0;
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

/// The family of each class, or nothing if a class is in none of them.
std::vector<std::size_t> families_of(const std::vector<std::string>& classes,
                                     const std::string& text) {
  const auto families = split(text, ',');
  std::vector<std::size_t> made;
  for (const std::string& name : classes)
    for (std::size_t f = 0; f < families.size(); ++f) {
      const auto members = split(families[f], '+');
      if (std::find(members.begin(), members.end(), name) == members.end()) continue;
      made.push_back(f);
      break;
    }
  if (made.size() != classes.size()) made.clear();
  return made;
}

Json document_of(const TaskResult& result, Method method, const std::vector<Judged>& grasps,
                 const std::string& families) {
  Json made{{"accuracy", accuracy(grasps)}, {"brier", brier(grasps)}};
  made["deviation_between_people"] = deviation_between_people(grasps);
  if (const auto family = families_of(result.classes, families); !family.empty())
    made["family_accuracy"] = family_accuracy(grasps, family);
  for (const double coverage : coverages)
    made["accuracy_at_coverage"].push_back(
        {{"coverage", coverage}, {"accuracy", accuracy_at(grasps, coverage)}});
  for (const double share : shares)
    made["accuracy_after"].push_back(
        {{"share", share}, {"accuracy", accuracy_after(grasps, share)}});
  for (const Bin& bin : reliability(grasps))
    if (bin.count > 0)
      made["reliability"].push_back({{"said", bin.said}, {"held", bin.held}, {"count", bin.count}});
  made["confusion"] = confusion(grasps, result.classes.size());
  if (const auto told = result.with_object.find(method); told != result.with_object.end())
    made["with_object"] = {{"accuracy", accuracy(told->second)},
                           {"brier", brier(told->second)},
                           {"errors", errors_of(told->second)},
                           {"errors_without", errors_of(grasps)},
                           {"fewer_errors", fewer(grasps, told->second)}};
  return made;
}

Json document_of(const std::vector<TaskResult>& results, const Takes& takes,
                 const std::string& families) {
  Json document;
  document["tasks"] = Json::object();
  for (const TaskResult& result : results) {
    Json& task = document["tasks"][result.task];
    const auto any = result.methods.begin();
    task["count"] = any == result.methods.end() ? 0 : any->second.size();
    task["methods"] = Json::object();
    for (const Method method : methods)
      if (const auto found = result.methods.find(method); found != result.methods.end())
        task["methods"][std::string(to_string(method))] =
            document_of(result, method, found->second, families);
    task["classes"] = result.classes;
    task["not_learnt"] = result.not_learnt;
  }
  document["rows"] = takes.rows;
  document["rows_left_out"] = takes.bad_rows;
  document["unknown_numbers"] = takes.unknown_numbers;
  document["files_left_out"] = takes.bad_files;
  return document;
}

void print_methods(const TaskResult& result, const std::string& families) {
  const auto family = families_of(result.classes, families);
  const std::size_t count = result.methods.begin()->second.size();
  to_terminal("\ntask {}: {} takes, {}\n", result.task, count, fmt::join(result.classes, ", "));
  to_terminal(
      "| method | right | Brier | right of surest 90 % | 80 % | 50 % | after 25 % | 50 % | "
      "75 % | between people |{}\n",
      family.empty() ? "" : " family |");
  to_terminal("|---|---|---|---|---|---|---|---|---|---|{}\n", family.empty() ? "" : "---|");
  for (const Method method : methods) {
    const auto found = result.methods.find(method);
    if (found == result.methods.end()) continue;
    const auto& grasps = found->second;
    to_terminal("| {} | {:.1f} % | {:.3f} |", to_string(method), 100 * accuracy(grasps),
                brier(grasps));
    for (std::size_t i = 1; i < coverages.size(); ++i)
      to_terminal(" {:.1f} % |", 100 * accuracy_at(grasps, coverages[i]));
    for (std::size_t i = 0; i + 1 < shares.size(); ++i)
      to_terminal(" {:.1f} % |", 100 * accuracy_after(grasps, shares[i]));
    to_terminal(" ±{:.1f} % |", 100 * deviation_between_people(grasps));
    if (!family.empty()) to_terminal(" {:.1f} % |", 100 * family_accuracy(grasps, family));
    to_terminal("\n");
  }
}

void print_objects(const TaskResult& result) {
  to_terminal("\n| object known | right | Brier | errors fewer |\n|---|---|---|---|\n");
  for (const Method method : methods) {
    const auto told = result.with_object.find(method);
    if (told == result.with_object.end()) continue;
    to_terminal("| {} | {:.1f} % | {:.3f} | {:.0f} % |\n", to_string(method),
                100 * accuracy(told->second), brier(told->second),
                100 * fewer(result.methods.at(method), told->second));
  }
}

void print_hybrid(const TaskResult& result) {
  const auto found = result.methods.find(Method::hybrid);
  if (found == result.methods.end()) return;
  to_terminal("\nhybrid\n| is \\ taken for | {} |\n|---|", fmt::join(result.classes, " | "));
  for (std::size_t i = 0; i < result.classes.size(); ++i) to_terminal("---|");
  const auto counts = confusion(found->second, result.classes.size());
  for (std::size_t row = 0; row < counts.size(); ++row)
    to_terminal("\n| {} | {} |", result.classes[row], fmt::join(counts[row], " | "));
  to_terminal("\n\n| said | held | takes |\n|---|---|---|\n");
  for (const Bin& bin : reliability(found->second))
    if (bin.count > 0) to_terminal("| {:.2f} | {:.2f} | {} |\n", bin.said, bin.held, bin.count);
}

/// People of one who are also in the other.
std::vector<std::string> common_people(const Takes& one, const Takes& other) {
  std::set<std::string> first, both;
  for (const Take& take : one.takes) first.insert(take.user);
  for (const Take& take : other.takes)
    if (first.contains(take.user)) both.insert(take.user);
  return {both.begin(), both.end()};
}

Expected<std::vector<TaskResult>> results_with_model(const Takes& takes, const std::string& file) {
  const auto all = load_recognisers(file);
  if (!all) return tl::unexpected(all.error());
  std::vector<TaskResult> results;
  for (const auto& [task, own] : by_task(takes.takes)) {
    std::vector<Recogniser> recognisers;
    for (const TaskRecogniser& one : *all)
      if (one.task == task) recognisers.push_back(one.recogniser);
    results.push_back(judge_with(task, own, recognisers));
    if (recognisers.empty())
      results.back().trouble =
          Error{"the model knows nothing of it", "task " + task, "train with takes of this task"};
  }
  return results;
}

Expected<std::vector<TaskResult>> results_of(const Takes& takes, const Arguments& arguments) {
  if (!arguments.model.empty()) return results_with_model(takes, arguments.model);
  Takes training;
  if (!arguments.training.empty()) {
    auto read = told_takes(arguments.training);
    if (!read) return tl::unexpected(read.error());
    training = std::move(*read);
    if (const auto both = common_people(takes, training); !both.empty())
      log::warning("people of the same name in both folders, maybe the same ones: {}",
                   fmt::join(both, ", "));
  }
  Progress progress("training");
  return judge(
      takes.takes, arguments.training.empty() ? nullptr : &training.takes, arguments.options,
      arguments.threads, [&](std::size_t done, std::size_t all) { progress.show(done, all); },
      arguments.with_object);
}

std::string needed(const Arguments& arguments) {
  if (!arguments.model.empty()) return "the model must have learnt the same tasks";
  return arguments.training.empty()
             ? "takes of at least three people and two kinds of grasps are needed"
             : "the other folder needs the same tasks, by two people and of two kinds of grasps";
}

int evaluate(const Arguments& arguments) {
  const auto takes = told_takes(arguments.folder);
  if (!takes) return tool::complain(takes.error());
  const auto results = results_of(*takes, arguments);
  if (!results) return tool::complain(results.error());
  bool any = false;
  for (const TaskResult& result : *results) {
    any |= !result.methods.empty();
    if (!result.methods.empty() && !result.not_learnt.empty())
      log::warning("task {}: nobody else showed {}: answered wrongly each time", result.task,
                   fmt::join(result.not_learnt, ", "));
    if (result.trouble)
      log::warning(Error{result.trouble->what, "task " + result.task, result.trouble->hint});
  }
  if (arguments.json) std::cout << document_of(*results, *takes, arguments.families) << "\n";
  if (!any) return tool::complain({"no task could be judged", arguments.folder, needed(arguments)});
  if (arguments.json) return exit_done;
  for (const TaskResult& result : *results) {
    if (result.methods.empty()) continue;
    print_methods(result, arguments.families);
    if (!result.with_object.empty()) print_objects(result);
    print_hybrid(result);
  }
  return exit_done;
}

}  // namespace

void add_evaluate(tool::Program& program) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = program.app().add_subcommand(
      "evaluate",
      "How often grasps of people who were not trained on are recognised: each person by what was "
      "learned from all others, or by what was learned from another folder or before.");
  command->add_option("folder", arguments->folder, "holds task*.csv")->required();
  auto* training = command->add_option("--train", arguments->training, "learn from this folder");
  auto* model =
      command->add_option("--model", arguments->model, "a trained model")->excludes(training);
  command
      ->add_flag("--with-object", arguments->with_object,
                 "also says how many are recognised once the object's shape and size are known")
      ->excludes(model);
  command
      ->add_option("--families", arguments->families,
                   "kinds of grasps that belong together: A+B,C+D")
      ->capture_default_str();
  command->add_option("--threads", arguments->threads, "0: all cores");
  command->add_option("--seed", arguments->options.seed, "of first weights")->capture_default_str();
  command->add_flag("--json", arguments->json, "one JSON document");
  program.on(*command, [arguments] { return evaluate(*arguments); });
}

}  // namespace prehend::demonstration
