// Not in [Thesis] as such: the live model asked for an object of a size that it was not trained
// on, between the trained ones or outside of them, where the nearest trained size answers.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>

#include "services/mapping/tools/study/experiment.hpp"
#include "services/mapping/tools/training/trainer.hpp"

namespace prehend::mapping {

namespace {

constexpr double not_tried = std::numeric_limits<double>::quiet_NaN();
constexpr std::array places{"between", "outside"};
/// Without the object: direct and intelligent mapping; and intelligent mapping trained with it.
constexpr std::array size_answerers{"direct", "intelligent", "intelligent, trained with it"};

std::string place_column(std::string_view hand, std::string_view place, std::string_view answerer) {
  return fmt::format("{} {}: {}", hand, place, answerer);
}

/// Whether the size of the object lies between those of the others of its shape.
bool lies_between(const std::vector<RobotGrasp>& others, const model::Shape& shape) {
  const double size = model::characteristic_size(shape);
  bool smaller = false, larger = false;
  for (const RobotGrasp& grasp : others) {
    if (grasp.shape.kind != shape.kind) continue;
    smaller = smaller || model::characteristic_size(grasp.shape) <= size;
    larger = larger || model::characteristic_size(grasp.shape) >= size;
  }
  return smaller && larger;
}

Eigen::VectorXd untrained_size_row(const Parts& parts, const Repetition& repetition) {
  Eigen::VectorXd numbers = Eigen::VectorXd::Constant(
      thesis_hands.size() * places.size() * size_answerers.size(), not_tried);
  const std::size_t h = repetition.index % thesis_hands.size();
  const StudiedHand& hand = parts.hand(thesis_hands[h]);
  std::set<std::string> names;
  for (const RobotGrasp& grasp : hand.grasps) names.insert(grasp.object);
  const auto gone =
      std::next(names.begin(),
                static_cast<std::ptrdiff_t>(repetition.index / thesis_hands.size() % names.size()));
  std::vector<RobotGrasp> others, left_out;
  for (const RobotGrasp& grasp : hand.grasps)
    (grasp.object == *gone ? left_out : others).push_back(grasp);
  const model::Shape& shape = left_out.front().shape;

  SetOptions people;
  people.seed = repetition.seed;
  Sets sets;
  sets.training = demonstrate(hand.hand, hand.scheme, others, people);
  people.users = 3;
  people.grasps = static_cast<int>(hand.grasps.size());
  ++people.seed;
  sets.validation = sets.test = demonstrate(hand.hand, hand.scheme, others, people);
  people.users = 5;
  ++people.seed;
  const auto tested = demonstrate(hand.hand, hand.scheme, left_out, people);
  TrainerOptions options;
  options.network.seed = static_cast<std::uint32_t>(repetition.seed);
  const auto made = train_mapping(
      hand.hand, hand.scheme, sets, options,
      [](std::size_t count, const auto& work) {
        for (std::size_t i = 0; i < count; ++i) work(i);
      },
      [](auto, auto) {});
  if (!made || !made->known_as(shape)) return numbers;
  const Comparison without = compare(*made, tested, shape.kind, true);
  const Comparison with = compare(*hand.model, tested, shape.kind, true);
  if (without.pairs == 0) return numbers;
  const std::size_t place = lies_between(others, shape) ? 0 : 1;
  const auto first = static_cast<Eigen::Index>((h * places.size() + place) * size_answerers.size());
  numbers.segment<3>(first) << without.direct, without.intelligent, with.intelligent;
  return numbers;
}

Outcome judge_untrained_size(const Table& table) {
  Outcome outcome;
  outcome.chart = {"", "error of a grasp, rad²", {}, false, true, {}};
  for (const char* answerer : size_answerers) outcome.chart.series.push_back({answerer, {}});
  for (const char* place : places) {
    Finding finding{"sizes",
                    fmt::format("A size {} the trained ones: knowing it errs less than not knowing "
                                "the object",
                                place == places[0] ? "between" : "outside"),
                    "", Reproduction::undecided, ""};
    std::vector<Reproduction> verdicts;
    for (const char* hand : thesis_hands) {
      std::array<std::vector<double>, size_answerers.size()> errors;
      for (std::size_t a = 0; a < size_answerers.size(); ++a) {
        errors[a] = table[place_column(hand, place, size_answerers[a])];
        outcome.chart.series[a].points.push_back({static_cast<double>(outcome.chart.names.size()),
                                                  statistics::geometric_mean(errors[a])});
      }
      outcome.chart.names.push_back(fmt::format("{} {}", hand, place));
      const statistics::Interval ratio = statistics::paired_ratio(errors[0], errors[1]);
      if (ratio.count < 2) continue;
      finding.measured += fmt::format("{}{}: direct {}, intelligent {}, trained with it {} rad²",
                                      finding.measured.empty() ? "" : "; ", hand,
                                      to_text(statistics::geometric_mean(errors[0])),
                                      to_text(statistics::geometric_mean(errors[1])),
                                      to_text(statistics::geometric_mean(errors[2])));
      finding.reason += fmt::format("{}{}: direct errs {} times as much",
                                    finding.reason.empty() ? "" : ", ", hand, to_text(ratio));
      verdicts.push_back(above_one(ratio));
    }
    if (!verdicts.empty()) finding.verdict = all_of(verdicts);
    outcome.findings.push_back(std::move(finding));
  }
  return outcome;
}

}  // namespace

Experiment untrained_sizes() {
  Experiment experiment{
      "sizes",
      "Sizes that were not trained",
      "The live model trained without one object, each in turn, and asked for the grasps that five "
      "other people make of it; beside it the build's model, which was trained with it",
      {thesis_hands.begin(), thesis_hands.end()},
      {},
      9,
      270,
      untrained_size_row,
      judge_untrained_size};
  experiment.trained = true;
  for (const char* hand : thesis_hands)
    for (const char* place : places)
      for (const char* answerer : size_answerers)
        experiment.columns.push_back(place_column(hand, place, answerer));
  return experiment;
}

}  // namespace prehend::mapping
