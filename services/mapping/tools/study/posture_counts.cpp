// Figure 5.18: how many postures direct mapping is trained on, and what that does to others.
#include <fmt/format.h>

#include <limits>

#include "services/mapping/tools/study/experiment.hpp"
#include "services/mapping/tools/study/imitation.hpp"

namespace prehend::mapping {

namespace {

constexpr std::array counts{4, 7, 10, 13};
constexpr int hidden_of_dlr = 8;  // the choice of [Thesis, figure 5.15] for the DLR hand

std::string trained(int count) {
  return fmt::format("trained {}", count);
}
std::string test(int count) {
  return fmt::format("test {}", count);
}

Eigen::VectorXd posture_count_row(const Parts& parts, const Repetition& repetition) {
  const Scheme& scheme = parts.hand("dlr").scheme;
  Demonstrator person("one", repetition.seed, {});
  const learning::Samples others = show(person, scheme.combinations());
  std::vector<double> numbers;
  for (const int count : counts) {
    const auto pairs = show(person, scheme.posture_set(count));
    ImitationOptions options;
    options.hidden = hidden_of_dlr;
    options.seed = repetition.seed;
    const auto made = Imitation::fit(pairs, options);
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    numbers.push_back(made ? made->error(pairs) : none);
    numbers.push_back(made ? made->error(others) : none);
  }
  return Eigen::VectorXd::Map(numbers.data(), static_cast<Eigen::Index>(numbers.size()));
}

std::string means(const Table& table, std::string (*column)(int)) {
  std::string text;
  for (const int count : counts)
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", count,
                        to_text(statistics::geometric_mean(table[column(count)])));
  return text + " rad²";
}

Outcome judge_posture_count(const Table& table) {
  Outcome outcome;
  // Steps of the curve in [Thesis, figure 5.18], one after the other.
  std::vector<Reproduction> rising;
  for (std::size_t i = 1; i < counts.size(); ++i)
    rising.push_back(above_one(
        statistics::paired_ratio(table[trained(counts[i])], table[trained(counts[i - 1])])));
  Finding training{"5.18", "DLR: the training error grows with the number of postures",
                   means(table, trained), all_of(rising), ""};
  training.reason = "each step from 4 to 7, 10 and 13 is judged, paired over persons";
  const statistics::Interval gain = statistics::paired_ratio(table[test(4)], table[test(7)]);
  Finding falls{
      "5.18", "DLR: the test error on new postures falls with the number of postures",
      means(table, test), above_one(gain),
      fmt::format("with 4 postures it is {} times that with 7, with 13 {} times that with "
                  "7, paired over persons",
                  to_text(gain),
                  to_text(statistics::paired_ratio(table[test(13)], table[test(7)])))};
  const statistics::Interval at_10 = statistics::deviation_ratio(table[test(10)], table[test(7)]);
  const statistics::Interval at_13 = statistics::deviation_ratio(table[test(13)], table[test(7)]);
  Finding unstable{
      "5.18", "DLR: above 7 postures the test error is unstable",
      fmt::format("spread over persons and first weights relative to that with 7: with 10 {}, "
                  "with 13 {}",
                  to_text(at_10), to_text(at_13)),
      Reproduction::undecided, ""};
  unstable.verdict = all_of(std::array{above_one(at_10), above_one(at_13)});
  unstable.reason = "both are judged against 1, by bootstrap over persons";
  outcome.findings = {training, falls, unstable};
  outcome.chart = {"",    "mean error of a posture, rad²",
                   {},    false,
                   false, {{"trained postures", {}}, {"new postures", {}}}};
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double x = static_cast<double>(i);
    outcome.chart.names.push_back(fmt::format("{} postures", counts[i]));
    outcome.chart.series[0].points.push_back(
        {x, statistics::geometric_mean(table[trained(counts[i])])});
    outcome.chart.series[1].points.push_back(
        {x, statistics::geometric_mean(table[test(counts[i])])});
  }
  return outcome;
}

}  // namespace

Experiment posture_counts() {
  Experiment experiment{
      "5.18",
      "Number of training postures, DLR",
      "Sets of 4, 7, 10 and 13 postures of one person, eight hidden neurons, "
      "RPROP, 1000 epochs; the new postures are the four of figure 5.17, shown by "
      "the same person",
      {"dlr"},
      {},
      100,
      1000,
      posture_count_row,
      judge_posture_count};
  for (const int count : counts) {
    experiment.columns.push_back(trained(count));
    experiment.columns.push_back(test(count));
  }
  return experiment;
}

}  // namespace prehend::mapping
