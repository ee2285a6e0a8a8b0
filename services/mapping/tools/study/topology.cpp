// Figures 5.14 to 5.16: hidden neurons of direct mapping, four postures; errors on the trained
// ones.
#include <fmt/format.h>

#include <limits>
#include <numbers>
#include <numeric>

#include "services/mapping/tools/study/experiment.hpp"
#include "services/mapping/tools/study/imitation.hpp"

namespace prehend::mapping {

namespace {

struct Range {
  int first, last;  // hidden neurons
};

std::string neurons(int hidden) {
  return fmt::format("{} neurons", hidden);
}

/// Geometric mean over some columns, repetition by repetition.
std::vector<double> mean_of(const Table& table, const std::vector<int>& hidden) {
  std::vector<double> mean, row(hidden.size());
  for (Eigen::Index i = 0; i < table.values.rows(); ++i) {
    for (std::size_t k = 0; k < hidden.size(); ++k)
      row[k] = table[neurons(hidden[k])][static_cast<std::size_t>(i)];
    mean.push_back(statistics::geometric_mean(row).mean);
  }
  return mean;
}

std::vector<int> from_to(int first, int last) {
  std::vector<int> all(static_cast<std::size_t>(last - first + 1));
  std::iota(all.begin(), all.end(), first);
  return all;
}

Chart chart_of(const Table& table, Range range) {
  Chart chart{"hidden neurons", "error over the four postures, rad²", {}, false, true, {{"", {}}}};
  chart.series[0].name = "mean of repetitions";
  for (int n = range.first; n <= range.last; ++n)
    chart.series[0].points.push_back(
        {static_cast<double>(n), statistics::geometric_mean(table[neurons(n)])});
  return chart;
}

std::string means(const Table& table, const std::vector<int>& hidden) {
  std::string text;
  for (const int n : hidden)
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", n,
                        to_text(statistics::geometric_mean(table[neurons(n)])));
  return text + " rad²";
}

Experiment hidden_neurons(std::string figure, std::string hand, Range range,
                          std::function<std::vector<Finding>(const Table&)> judge) {
  Experiment experiment{
      std::move(figure),
      fmt::format("Hidden neurons of direct mapping, {}", hand),
      "Four postures of one person, RPROP, 1000 epochs; eq. 5.1 summed over the trained postures",
      {hand},
      {},
      100,
      1000,
      [hand, range](const Parts& parts, const Repetition& repetition) {
        Demonstrator person("one", repetition.seed, {});
        const auto pairs = show(person, parts.hand(hand).scheme.posture_set(4));
        Eigen::VectorXd row(range.last - range.first + 1);
        for (int n = range.first; n <= range.last; ++n) {
          ImitationOptions options;
          options.hidden = n;
          options.seed = repetition.seed;
          const auto made = Imitation::fit(pairs, options);
          row[n - range.first] =
              made ? 4 * made->error(pairs) : std::numeric_limits<double>::quiet_NaN();
        }
        return row;
      },
      [judge, range](const Table& table) {
        return Outcome{judge(table), chart_of(table, range)};
      }};
  for (int n = range.first; n <= range.last; ++n) experiment.columns.push_back(neurons(n));
  return experiment;
}

}  // namespace

Experiment hidden_neurons_barrett() {
  return hidden_neurons("5.14", "barrett", {2, 6}, [](const Table& table) {
    Finding best{"5.14", "Barrett: 4 hidden neurons, the number of outputs, are best of 2 to 6",
                 means(table, from_to(2, 6)), Reproduction::undecided,
                 "relative to the error with 4:"};
    std::vector<Reproduction> verdicts;
    for (const int n : {2, 3, 5, 6}) {
      const statistics::Interval ratio =
          statistics::paired_ratio(table[neurons(n)], table[neurons(4)]);
      verdicts.push_back(above_one(ratio));
      best.reason += fmt::format(" {} with {}{}", to_text(ratio), n, n < 6 ? "," : "");
    }
    best.verdict = all_of(verdicts);
    return std::vector{best};
  });
}

Experiment hidden_neurons_dlr() {
  return hidden_neurons("5.15", "dlr", {2, 16}, [](const Table& table) {
    // Four postures of twelve DoF, each off by one degree.
    constexpr double one_degree = 4 * 12 * (std::numbers::pi / 180) * (std::numbers::pi / 180);
    const auto eight = table[neurons(8)], twelve = table[neurons(12)];
    const statistics::Interval with_8 = statistics::mean_interval(eight);
    Finding enough{
        "5.15", "DLR: 8 hidden neurons are enough", means(table, {2, 4, 6, 8, 10, 12}),
        above_zero({one_degree - with_8.mean, one_degree - with_8.high, one_degree - with_8.low,
                    with_8.count}),
        fmt::format("with 8 the arithmetic mean is {} rad²; one degree in each DoF would "
                    "be {:.3g}",
                    to_text(with_8), one_degree)};
    const auto above = mean_of(table, from_to(13, 16));
    const statistics::Interval growth = statistics::paired_ratio(above, twelve);
    Finding grows{
        "5.15", "DLR: above 12 hidden neurons, the number of outputs, the error grows",
        fmt::format("12: {}, 13 to 16: {} rad²", to_text(statistics::geometric_mean(twelve)),
                    to_text(statistics::geometric_mean(above))),
        above_one(growth), ""};
    grows.reason = fmt::format("it grows by a factor of {}, paired over persons", to_text(growth));
    return std::vector{enough, grows};
  });
}

Experiment hidden_neurons_robonaut() {
  return hidden_neurons("5.16", "robonaut", {3, 16}, [](const Table& table) {
    int lowest = 3, highest = 3;
    const auto typical = [&](int n) { return statistics::geometric_mean(table[neurons(n)]).mean; };
    for (int n = 4; n <= 16; ++n) {
      if (typical(n) < typical(lowest)) lowest = n;
      if (typical(n) > typical(highest)) highest = n;
    }
    const statistics::Interval span =
        statistics::paired_ratio(table[neurons(highest)], table[neurons(lowest)]);
    Finding flat{"5.16", "Robonaut: the error is quite flat from 3 to 16 hidden neurons",
                 fmt::format("lowest with {}: {}, highest with {}: {} rad²", lowest,
                             to_text(statistics::geometric_mean(table[neurons(lowest)])), highest,
                             to_text(statistics::geometric_mean(table[neurons(highest)]))),
                 above_one({2 / span.mean, 2 / span.high, 2 / span.low, span.count}, 1),
                 fmt::format("highest over lowest is {}, judged with 2", to_text(span))};
    const auto below = mean_of(table, from_to(3, 8)), inside = mean_of(table, from_to(9, 13)),
               above = mean_of(table, from_to(14, 16));
    const statistics::Interval from_below = statistics::paired_ratio(below, inside),
                               from_above = statistics::paired_ratio(above, inside);
    Finding best{"5.16", "Robonaut: 9 to 13 hidden neurons are best",
                 fmt::format("3 to 8: {}, 9 to 13: {}, 14 to 16: {} rad²",
                             to_text(statistics::geometric_mean(below)),
                             to_text(statistics::geometric_mean(inside)),
                             to_text(statistics::geometric_mean(above))),
                 all_of(std::array{above_one(from_below), above_one(from_above)}),
                 fmt::format("3 to 8 err {} times as much, 14 to 16 {} times", to_text(from_below),
                             to_text(from_above))};
    return std::vector{flat, best};
  });
}

}  // namespace prehend::mapping
