// Figures 5.12 and 5.13: the Barrett hand, four postures, four hidden neurons, one person.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "services/mapping/tools/study/experiment.hpp"
#include "services/mapping/tools/study/imitation.hpp"

namespace prehend::mapping {

namespace {

using learning::TrainingMethod;

/// The four of [Thesis, figure 5.12]; the others are shown beside them.
constexpr std::array thesis_methods{TrainingMethod::incremental, TrainingMethod::batch,
                                    TrainingMethod::rprop, TrainingMethod::quickprop};
constexpr int budget = 3000;     // epochs
constexpr double target = 1e-3;  // FANN's mean square error, the customary end of training
constexpr int hidden = 4, outputs = 4;
constexpr std::array looks{1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 3000};  // epochs

/// FANN's measure: mean over outputs, of differences that are halved where the range is [-1, 1].
double fann_error(double squared) {
  return squared / (4.0 * outputs);
}

std::string column(TrainingMethod method, std::string_view what) {
  return fmt::format("{} {}", learning::to_string(method), what);
}
std::string at_epoch(TrainingMethod method, int epoch) {
  return column(method, fmt::format("at {}", epoch));
}

Expected<Imitation> trained(const Parts& parts, const Repetition& repetition,
                            TrainingMethod method) {
  const StudiedHand& barrett = parts.hand("barrett");
  Demonstrator person("one", repetition.seed, {});
  const learning::Samples pairs = show(person, barrett.scheme.posture_set(4));
  ImitationOptions options;
  options.method = method;
  options.hidden = hidden;
  options.epochs = budget;
  options.curve = true;
  options.seed = repetition.seed;
  return Imitation::fit(pairs, options);
}

Eigen::VectorXd convergence_row(const Parts& parts, const Repetition& repetition) {
  std::vector<double> row;
  for (const TrainingMethod method : learning::training_methods) {
    const auto made = trained(parts, repetition, method);
    const std::vector<learning::Look> curve =
        made ? made->training().curve : std::vector<learning::Look>{};
    const auto there = std::find_if(curve.begin(), curve.end(), [](const learning::Look& look) {
      return fann_error(look.training) <= target;
    });
    row.push_back(there == curve.end() ? budget : there->epoch);
    for (const int epoch : looks) {
      double error = std::numeric_limits<double>::quiet_NaN();
      for (const learning::Look& look : curve)
        if (look.epoch <= epoch) error = fann_error(look.training);
      row.push_back(error);
    }
  }
  return Eigen::VectorXd::Map(row.data(), static_cast<Eigen::Index>(row.size()));
}

/// Whether one method's numbers lie below those of each other one.
Finding below_all_others(const Table& table, TrainingMethod first, bool above,
                         std::string_view what, std::string_view unit) {
  Finding finding;
  std::vector<Reproduction> verdicts;
  const auto mine = table[column(first, what)];
  for (const TrainingMethod method : thesis_methods) {
    const auto theirs = table[column(method, what)];
    finding.measured +=
        fmt::format("{}{} {}", finding.measured.empty() ? "" : ", ", learning::to_string(method),
                    to_text(statistics::geometric_mean(theirs)));
    if (method == first) continue;
    verdicts.push_back(above_one(above ? statistics::paired_ratio(mine, theirs)
                                       : statistics::paired_ratio(theirs, mine)));
  }
  finding.measured += fmt::format(" {}", unit);
  finding.verdict = all_of(verdicts);
  return finding;
}

Outcome judge_convergence(const Table& table) {
  Outcome outcome;
  const std::string unit =
      fmt::format("epochs until FANN's error is {} (at most {})", target, budget);
  Finding fastest = below_all_others(table, TrainingMethod::quickprop, false, "epochs", unit);
  fastest.figure = "5.12";
  fastest.claim = "Quickprop converges fastest of the four methods";
  fastest.reason = "in epochs, paired over persons";
  Finding longest = below_all_others(table, TrainingMethod::rprop, true, "epochs", unit);
  longest.figure = "5.12";
  longest.claim = "RPROP needs longest of the four methods";
  const auto still_falls = [&](TrainingMethod method) {
    return to_text(
        statistics::paired_ratio(table[at_epoch(method, 1000)], table[at_epoch(method, budget)]));
  };
  longest.reason = fmt::format(
      "it reaches that error early, but improves longest: between epochs 1000 and {} its error "
      "falls by a factor of {}, quickprop's by {}",
      budget, still_falls(TrainingMethod::rprop), still_falls(TrainingMethod::quickprop));
  outcome.findings = {fastest, longest};
  outcome.chart = {"epochs", "FANN's mean square error", {}, true, true, {}};
  for (const TrainingMethod method : learning::training_methods) {
    ChartSeries series{std::string(learning::to_string(method)), {}};
    for (const int epoch : looks) {
      const statistics::Interval error = statistics::geometric_mean(table[at_epoch(method, epoch)]);
      if (error.count > 1) series.points.push_back({static_cast<double>(epoch), error});
    }
    outcome.chart.series.push_back(std::move(series));
  }
  return outcome;
}

Eigen::VectorXd error_row(const Parts& parts, const Repetition& repetition) {
  Eigen::VectorXd row(learning::training_methods.size());
  for (std::size_t i = 0; i < learning::training_methods.size(); ++i) {
    const StudiedHand& barrett = parts.hand("barrett");
    Demonstrator person("one", repetition.seed, {});
    const learning::Samples pairs = show(person, barrett.scheme.posture_set(4));
    const auto made = trained(parts, repetition, learning::training_methods[i]);
    row[static_cast<Eigen::Index>(i)] =
        made ? 4 * made->error(pairs) : std::numeric_limits<double>::quiet_NaN();
  }
  return row;
}

Outcome judge_error(const Table& table) {
  Outcome outcome;
  Finding lowest = below_all_others(table, TrainingMethod::rprop, false, "error",
                                    fmt::format("rad² over the four postures, {} epochs", budget));
  lowest.figure = "5.13";
  lowest.claim = "RPROP reaches the lowest training error of the four methods";
  lowest.reason = "paired over persons";
  outcome.findings = {lowest};
  outcome.chart = {"", "error over the four postures, rad²", {}, false, true, {{"error", {}}}};
  for (const TrainingMethod method : learning::training_methods) {
    outcome.chart.series[0].points.push_back(
        {static_cast<double>(outcome.chart.names.size()),
         statistics::geometric_mean(table[column(method, "error")])});
    outcome.chart.names.emplace_back(learning::to_string(method));
  }
  return outcome;
}

}  // namespace

Experiment convergence() {
  Experiment experiment{"5.12",
                        "How the training methods converge",
                        "Barrett hand, four postures of one person, four hidden neurons; the same "
                        "first weights for the methods that start from a layer of them",
                        {"barrett"},
                        {},
                        100,
                        1000,
                        convergence_row,
                        judge_convergence};
  for (const TrainingMethod method : learning::training_methods) {
    experiment.columns.push_back(column(method, "epochs"));
    for (const int epoch : looks) experiment.columns.push_back(at_epoch(method, epoch));
  }
  return experiment;
}

Experiment lowest_error() {
  Experiment experiment{"5.13",
                        "Training error of the methods",
                        "As figure 5.12; eq. 5.1 summed over the four trained postures",
                        {"barrett"},
                        {},
                        100,
                        1000,
                        error_row,
                        judge_error};
  for (const TrainingMethod method : learning::training_methods)
    experiment.columns.push_back(column(method, "error"));
  return experiment;
}

}  // namespace prehend::mapping
