// Beyond the figures: how inputs are scaled, and what an intelligent network is told of the size.
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "common/statistics/intervals.hpp"
#include "services/mapping/core/size_input.hpp"
#include "services/mapping/tools/study/grasp_task.hpp"

namespace prehend::mapping {

namespace {

using learning::ScalingKind;
using model::ShapeKind;

constexpr double no_number = std::numeric_limits<double>::quiet_NaN();
constexpr std::array tested_on{"new take", "left out"};

std::string variant_column(std::string_view variant, std::string_view test) {
  return fmt::format("{}: {}", variant, test);
}

std::vector<std::string> columns_of(std::span<const std::string> variants) {
  std::vector<std::string> columns;
  for (const std::string& variant : variants)
    for (const char* test : tested_on) columns.push_back(variant_column(variant, test));
  return columns;
}

/// Errors of one variant: mean over the grasp types, of a new take and of what was left out.
/// numbers: what the network is told of a grasp's object.
Eigen::Vector2d errors(const Parts& parts, const Repetition& repetition, const std::string& hand,
                       ShapeKind shape, ImitationOptions options,
                       const std::function<Eigen::VectorXd(const RobotGrasp&)>& numbers) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero(), count = sum;
  options.seed = repetition.seed;
  for (const GraspType type : grasp_types) {
    const auto task = grasp_task(parts, hand, shape, type, repetition.index);
    if (!task || !task->left_out) continue;
    const auto shown = show(*task, parts.hand(hand), repetition.seed);
    if (!shown) continue;
    std::vector<learning::Samples> trained, again;
    for (std::size_t i = 0; i < task->trained.size(); ++i) {
      const Eigen::VectorXd size = numbers(*task->trained[i]);
      trained.push_back(with_size(shown->trained[i], size));
      again.push_back(with_size(shown->again[i], size));
    }
    const auto made = Imitation::fit(joined(trained), options);
    if (!made) continue;
    const Eigen::Vector2d now(made->error(joined(again)),
                              made->error(with_size(shown->left_out, numbers(*task->left_out))));
    sum += now;
    count.array() += 1;
  }
  return (count.array() > 0).select(sum.array() / count.array(), no_number);
}

Chart chart_of_variants(const Table& table, std::span<const std::string> variants) {
  Chart chart{"", "mean error of a grasp, rad²", {}, false, true, {}};
  chart.names.assign(variants.begin(), variants.end());
  for (const char* test : tested_on) {
    ChartSeries series{test, {}};
    for (std::size_t i = 0; i < variants.size(); ++i)
      series.points.push_back(
          {static_cast<double>(i),
           statistics::geometric_mean(table[variant_column(variants[i], test)])});
    chart.series.push_back(std::move(series));
  }
  return chart;
}

/// The means of all variants, and whether one is no worse than another: by less than a twentieth.
Finding no_worse(const Table& table, std::span<const std::string> variants, std::string figure,
                 std::string claim, const std::string& judged, const std::string& best) {
  Finding finding{std::move(figure), std::move(claim), "", Reproduction::undecided, ""};
  for (const char* test : tested_on) {
    finding.measured += fmt::format("{}{}: ", finding.measured.empty() ? "" : "; ", test);
    for (std::size_t i = 0; i < variants.size(); ++i)
      finding.measured += fmt::format(
          "{}{} {}", i > 0 ? ", " : "", variants[i],
          to_text(statistics::geometric_mean(table[variant_column(variants[i], test)])));
  }
  finding.measured += " rad²";
  const statistics::Interval ratio = statistics::paired_ratio(
      table[variant_column(judged, tested_on[0])], table[variant_column(best, tested_on[0])]);
  finding.verdict =
      above_one({1.05 / ratio.mean, 1.05 / ratio.high, 1.05 / ratio.low, ratio.count}, 1);
  finding.reason = fmt::format(
      "on new takes «{}» errs {} times as much as «{}», judged with 1.05, paired over {} persons",
      judged, to_text(ratio), best, ratio.count);
  return finding;
}

struct ScalingVariant {
  ScalingKind kind;
  double size_unit;
};
const std::vector<std::string> scaling_names{"each feature", "whole matrix",
                                             "whole matrix, tips in cm, sizes in mm", "as printed"};
constexpr std::array scaling_variants{
    ScalingVariant{ScalingKind::each_feature, 1}, ScalingVariant{ScalingKind::whole_matrix, 1},
    ScalingVariant{ScalingKind::whole_matrix, 10}, ScalingVariant{ScalingKind::as_printed, 1}};

const std::vector<std::string> size_names{"nothing", "one number", "all dimensions",
                                          "as the hand meets it"};

Eigen::VectorXd told_size(std::size_t variant, const RobotGrasp& grasp) {
  constexpr std::array inputs{SizeInput::characteristic, SizeInput::dimensions, SizeInput::seen};
  if (variant == 0) return Eigen::VectorXd(0);
  return size_numbers(inputs[variant - 1], grasp.shape, grasp.X_OG);
}

}  // namespace

Experiment scalings() {
  return {"4.11-4.16",
          "Scaling by eq. 4.11 to 4.16, DLR on cylinders",
          "As figure 6.5, intelligent mapping; inputs and outputs scaled in four ways",
          {"dlr"},
          columns_of(scaling_names),
          100,
          1000,
          [](const Parts& parts, const Repetition& repetition) {
            Eigen::VectorXd row(2 * scaling_variants.size());
            for (std::size_t i = 0; i < scaling_variants.size(); ++i) {
              ImitationOptions options;
              options.hidden = 8;
              options.scaling = scaling_variants[i].kind;
              options.size_unit = scaling_variants[i].size_unit;
              row.segment<2>(static_cast<Eigen::Index>(2 * i)) =
                  errors(parts, repetition, "dlr", ShapeKind::cylinder, options, thesis_size);
            }
            return row;
          },
          [](const Table& table) {
            Finding meant = no_worse(table, scaling_names, "4.11-4.16",
                                     "One range for the whole matrix loses nothing against a range "
                                     "for each feature",
                                     scaling_names[1], scaling_names[0]);
            return Outcome{{meant}, chart_of_variants(table, scaling_names)};
          }};
}

Experiment size_inputs() {
  return {"5.19",
          "What the network is told of the size, DLR on boxes",
          "As figure 6.5, on boxes, each feature scaled by itself",
          {"dlr"},
          columns_of(size_names),
          100,
          1000,
          [](const Parts& parts, const Repetition& repetition) {
            Eigen::VectorXd row(2 * size_names.size());
            for (std::size_t i = 0; i < size_names.size(); ++i) {
              ImitationOptions options;
              options.hidden = 8;
              options.scaling = ScalingKind::each_feature;
              row.segment<2>(static_cast<Eigen::Index>(2 * i)) =
                  errors(parts, repetition, "dlr", ShapeKind::box, options,
                         [i](const RobotGrasp& grasp) { return told_size(i, grasp); });
            }
            return row;
          },
          [](const Table& table) {
            Finding one = no_worse(table, size_names, "5.19",
                                   "One neuron for the size is enough: all dimensions do no better",
                                   size_names[1], size_names[2]);
            return Outcome{{one}, chart_of_variants(table, size_names)};
          }};
}

}  // namespace prehend::mapping
