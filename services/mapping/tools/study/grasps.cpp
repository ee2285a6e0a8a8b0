// Figures 6.5, 6.7 and 6.9: grasps by direct mapping and by mapping that knows shape and size.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "common/statistics/intervals.hpp"
#include "services/mapping/tools/study/grasp_task.hpp"

namespace prehend::mapping {

namespace {

using model::ShapeKind;

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// Who answers: without shape and size, trained on exactly the pairs of the third; the same, but
/// one network for the pairs of all shapes and grasp types; and with shape and size.
constexpr std::array answerers{"direct", "direct for all", "intelligent"};
constexpr std::size_t intelligent = 2;

/// On what: one person as in [Thesis, chapter 6], or several, and then another.
/// An object that was left out lies between the trained sizes or outside of them.
constexpr std::array tests{"trained",
                           "new take",
                           "between",
                           "outside",
                           "new person",
                           "new person, between",
                           "new person, outside"};

std::string measure(std::string_view answerer, std::string_view test) {
  return fmt::format("{} {}", answerer, test);
}
std::string column(GraspType type, std::string_view what) {
  return fmt::format("{}: {}", to_string(type), what);
}

struct Comparison {
  std::string figure, hand;
  ShapeKind shape;
  int hidden;        // the choice of [Thesis, 5.2.2] for the hand
  std::string only;  // tested on this object alone; empty: on all that were trained
};

/// What several people have shown of one task.
struct Recorded {
  GraspType type;
  GraspTask task;
  std::vector<ShownTask> people;
};

std::vector<Recorded> record(const Comparison& what, ShapeKind shape, const Parts& parts,
                             std::size_t turn, const std::vector<std::uint64_t>& seeds) {
  std::vector<Recorded> all;
  for (const GraspType type : grasp_types) {
    const auto task = grasp_task(parts, what.hand, shape, type, turn, what.only);
    if (!task) continue;
    Recorded recorded{type, *task, {}};
    for (const std::uint64_t seed : seeds)
      if (auto shown = show(*task, parts.hand(what.hand), seed))
        recorded.people.push_back(std::move(*shown));
    if (!recorded.people.empty()) all.push_back(std::move(recorded));
  }
  return all;
}

/// The training pairs of all people in it, with the size or without.
learning::Samples pairs_of(const Recorded& recorded, bool with_sizes) {
  std::vector<learning::Samples> pairs;
  for (const ShownTask& shown : recorded.people)
    pairs.push_back(with_sizes ? sized(shown.trained, recorded.task.trained)
                               : joined(shown.trained));
  return joined(pairs);
}

double error_of(const Imitation& network, const learning::Samples& grasp, const RobotGrasp& of,
                bool with_sizes) {
  return network.error(with_sizes ? with_size(grasp, thesis_size(of)) : grasp);
}

/// Mean over the tested grasps of a new take.
double error_again(const Imitation& network, const Comparison& what, const GraspTask& task,
                   const ShownTask& shown, bool with_sizes) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < task.trained.size(); ++i) {
    if (!what.only.empty() && task.trained[i]->object != what.only) continue;
    sum += error_of(network, shown.again[i], *task.trained[i], with_sizes);
    ++count;
  }
  return count > 0 ? sum / count : none;
}

/// Whether the size that was left out lies between trained ones.
bool lies_between(const GraspTask& task) {
  const auto size = [](const RobotGrasp* grasp) { return thesis_size(*grasp)[0]; };
  const auto [least, most] = std::minmax_element(task.trained.begin(), task.trained.end(),
                                                 [&](auto a, auto b) { return size(a) < size(b); });
  return size(*least) < size(task.left_out) && size(task.left_out) < size(*most);
}

/// The numbers of one repetition, put where their column is.
class Row {
 public:
  Row() : values_(Eigen::VectorXd::Constant(grasp_types.size() * per_type, none)) {}

  void put(GraspType type, std::size_t answerer, std::string_view test, double value) {
    const auto t = std::find(grasp_types.begin(), grasp_types.end(), type) - grasp_types.begin();
    const auto k = std::find(tests.begin(), tests.end(), test) - tests.begin();
    values_[t * static_cast<std::ptrdiff_t>(per_type) +
            static_cast<std::ptrdiff_t>(answerer * tests.size()) + k] = value;
  }
  const Eigen::VectorXd& values() const { return values_; }

 private:
  static constexpr std::size_t per_type = answerers.size() * tests.size();
  Eigen::VectorXd values_;
};

/// Trains on these people and tests on `tested`, or on a new take of the only person.
void compare(const Comparison& what, const Parts& parts, std::size_t turn,
             const std::vector<std::uint64_t>& people, std::optional<std::uint64_t> tested,
             const ImitationOptions& options, Row& row) {
  const auto recorded = record(what, what.shape, parts, turn, people);
  std::vector<learning::Samples> everything;
  for (const ShapeKind shape : {ShapeKind::cylinder, ShapeKind::box})
    for (const Recorded& set : record(what, shape, parts, turn, people))
      everything.push_back(pairs_of(set, false));
  if (recorded.empty()) return;
  const auto for_all = Imitation::fit(joined(everything), options);
  for (const Recorded& set : recorded) {
    const auto shown =
        tested ? show(set.task, parts.hand(what.hand), *tested) : std::optional(set.people.front());
    if (!shown) continue;
    const std::array networks{Imitation::fit(pairs_of(set, false), options), for_all,
                              Imitation::fit(pairs_of(set, true), options)};
    for (std::size_t a = 0; a < networks.size(); ++a) {
      if (!networks[a]) continue;
      const Imitation& network = *networks[a];
      const bool with_sizes = a == intelligent;
      if (!tested) row.put(set.type, a, "trained", network.error(pairs_of(set, with_sizes)));
      row.put(set.type, a, tested ? "new person" : "new take",
              error_again(network, what, set.task, *shown, with_sizes));
      if (!set.task.left_out) continue;
      const std::string place = lies_between(set.task) ? "between" : "outside";
      row.put(set.type, a, tested ? "new person, " + place : place,
              error_of(network, shown->left_out, *set.task.left_out, with_sizes));
    }
  }
}

Eigen::VectorXd repeat(const Comparison& what, const Parts& parts, const Repetition& repetition) {
  Row row;
  ImitationOptions options;
  options.hidden = what.hidden;
  options.seed = repetition.seed;
  compare(what, parts, repetition.index, {repetition.seed}, std::nullopt, options, row);

  // Several people cannot be learnt by heart, so fewer epochs do.
  constexpr std::uint64_t many = 5;
  options.epochs = 300;
  options.scaling = learning::ScalingKind::each_feature;
  std::vector<std::uint64_t> people;
  for (std::uint64_t i = 1; i <= many; ++i) people.push_back(repetition.seed + i);
  compare(what, parts, repetition.index, people, repetition.seed + many + 1, options, row);
  return row.values();
}

Chart chart_of(const Table& table, const std::vector<std::string>& shown) {
  Chart chart{"", "error of a grasp, rad²", {}, false, true, {}};
  // Not every hand makes every type of grasp on such objects.
  std::vector<GraspType> made;
  for (const GraspType type : grasp_types)
    if (statistics::geometric_mean(table[column(type, shown.front())]).count > 0)
      made.push_back(type);
  for (const GraspType type : made) chart.names.emplace_back(to_string(type));
  for (const std::string& what : shown) {
    ChartSeries series{what, {}};
    for (std::size_t t = 0; t < made.size(); ++t)
      series.points.push_back(
          {static_cast<double>(t), statistics::geometric_mean(table[column(made[t], what)])});
    chart.series.push_back(std::move(series));
  }
  return chart;
}

/// Both typical errors, and whether the second is above the first.
Finding larger(const Table& table, std::string figure, std::string claim, const std::string& less,
               const std::string& more) {
  const auto a = over_types(table, less), b = over_types(table, more);
  const statistics::Interval ratio = statistics::paired_ratio(b, a);
  return {std::move(figure), std::move(claim),
          fmt::format("{}: {}, {}: {} rad²", less, to_text(statistics::geometric_mean(a)), more,
                      to_text(statistics::geometric_mean(b))),
          above_one(ratio),
          fmt::format("the latter is {} times the former, paired over {} persons, mean over the "
                      "grasp types that the hand can make",
                      to_text(ratio), ratio.count)};
}

/// What [Thesis, figures 6.5 and 6.7] have in common.
Outcome judge(const Table& table, const std::string& figure, const std::string& what) {
  const auto lower = [&](std::string_view claim, std::string_view test, std::string_view direct) {
    return larger(table, figure, fmt::format("{}: {}", what, claim), measure("intelligent", test),
                  measure(direct, test));
  };
  Outcome outcome;
  outcome.findings = {
      larger(table, figure, what + ": knowing the size raises the training error",
             measure("direct", "trained"), measure("intelligent", "trained")),
      lower("knowing the size lowers the test error; one person, the same pairs", "new take",
            "direct"),
      lower("knowing shape and size lowers the test error; one person, direct mapping is one "
            "network for all",
            "new take", "direct for all"),
      lower("knowing shape and size lowers the test error; five people, tested on a sixth, direct "
            "mapping is one network for all",
            "new person", "direct for all"),
      lower("the same on an object whose size lies between the trained ones", "new person, between",
            "direct for all"),
      lower("the same on an object whose size lies outside of them", "new person, outside",
            "direct for all")};
  std::vector<std::string> shown;
  for (const char* test : {"new take", "new person"})
    for (const char* answerer : answerers) shown.push_back(measure(answerer, test));
  outcome.chart = chart_of(table, shown);
  return outcome;
}

Outcome judge_small_cube(const Table& table) {
  Outcome outcome;
  for (const auto& [test, who] : {std::pair{"new take", "one person"},
                                  std::pair{"new person", "five people, tested on a sixth"}}) {
    Finding finding{"6.9",
                    fmt::format("Barrett, small cube: knowing shape and size lowers the test error "
                                "in each grasp type; {}",
                                who),
                    "", Reproduction::undecided, ""};
    std::vector<Reproduction> verdicts;
    for (const GraspType type : grasp_types) {
      const auto a = table[column(type, measure("direct for all", test))],
                 b = table[column(type, measure("intelligent", test))];
      const statistics::Interval ratio = statistics::paired_ratio(a, b);
      if (ratio.count < 2) continue;
      finding.measured += fmt::format("{}{}: direct for all {}, intelligent {} rad²",
                                      finding.measured.empty() ? "" : "; ", to_string(type),
                                      to_text(statistics::geometric_mean(a)),
                                      to_text(statistics::geometric_mean(b)));
      finding.reason += fmt::format("{}{}: {} times", finding.reason.empty() ? "" : ", ",
                                    to_string(type), to_text(ratio));
      verdicts.push_back(above_one(ratio));
    }
    finding.verdict = all_of(verdicts);
    outcome.findings.push_back(std::move(finding));
  }
  outcome.chart = chart_of(
      table, {measure("direct for all", "new take"), measure("intelligent", "new take"),
              measure("direct for all", "new person"), measure("intelligent", "new person")});
  return outcome;
}

Experiment comparison(const Comparison& what, std::string title,
                      std::function<Outcome(const Table&)> judged) {
  std::vector<std::string> columns;
  for (const GraspType type : grasp_types)
    for (const char* answerer : answerers)
      for (const char* test : tests) columns.push_back(column(type, measure(answerer, test)));
  std::string method =
      "One network a shape and grasp type: for each object but one, in turn, the seven basic "
      "postures and one grasp. «Direct» learns the same pairs without the size, «direct for all» "
      "those of all shapes and types in one network. New take: one person as in the thesis, who "
      "puts "
      "the glove on again (RPROP, 1000 epochs, one range for the whole matrix); new person: five "
      "people, tested on a sixth (300 epochs, each feature scaled by itself). The object that "
      "was not trained lies between the sizes that were, or outside of them";
  if (!what.only.empty()) method += ". Tested on this object alone: " + what.only;
  return {what.figure,
          std::move(title),
          std::move(method),
          {what.hand},
          std::move(columns),
          24,
          300,
          [what](const Parts& parts, const Repetition& repetition) {
            return repeat(what, parts, repetition);
          },
          std::move(judged)};
}

}  // namespace

Experiment cylinders() {
  return comparison({"6.5", "dlr", ShapeKind::cylinder, 8, ""},
                    "Cylinders, DLR: direct against intelligent",
                    [](const Table& table) { return judge(table, "6.5", "DLR, cylinders"); });
}

Experiment boxes() {
  return comparison({"6.7", "robonaut", ShapeKind::box, 9, ""},
                    "Boxes, Robonaut: direct against intelligent",
                    [](const Table& table) { return judge(table, "6.7", "Robonaut, boxes"); });
}

Experiment small_cube() {
  return comparison({"6.9", "barrett", ShapeKind::box, 4, "Wood cube"},
                    "Small cube, Barrett: direct against intelligent", judge_small_cube);
}

}  // namespace prehend::mapping
