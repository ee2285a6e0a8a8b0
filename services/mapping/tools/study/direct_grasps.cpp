// Figure 6.2: direct mapping on grasps that it has learnt, before and after the glove is put on
// again.
#include <fmt/format.h>

#include <limits>

#include "common/statistics/intervals.hpp"
#include "services/mapping/tools/study/grasp_task.hpp"

namespace prehend::mapping {

namespace {

Eigen::VectorXd direct_grasp_row(const Parts& parts, const Repetition& repetition) {
  Eigen::VectorXd errors = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  const auto task = grasp_task(parts, "barrett", model::ShapeKind::cylinder, GraspType::precision,
                               repetition.index);
  if (!task) return errors;
  const auto shown = show(*task, parts.hand("barrett"), repetition.seed);
  if (!shown) return errors;
  // The postures once; each object's pairs end with its grasp.
  std::vector<learning::Samples> pairs{shown->trained.front()}, grasps;
  for (std::size_t i = 0; i < shown->trained.size(); ++i) {
    const learning::Samples& all = shown->trained[i];
    grasps.push_back({all.inputs.rightCols(1), all.outputs.rightCols(1)});
    if (i > 0) pairs.push_back(grasps.back());
  }
  ImitationOptions options;
  options.hidden = 4;
  options.seed = repetition.seed;
  if (const auto made = Imitation::fit(joined(pairs), options))
    errors << made->error(joined(grasps)), made->error(joined(shown->again));
  return errors;
}

Outcome judge_direct_grasp(const Table& table) {
  const auto before = table["trained"], after = table["new take"];
  const statistics::Interval rise = statistics::paired_ratio(after, before);
  const Finding finding{
      "6.2", "Barrett: on newly recorded takes of the trained grasps the error rises",
      fmt::format("trained: {}, new take: {} rad²", to_text(statistics::geometric_mean(before)),
                  to_text(statistics::geometric_mean(after))),
      above_one(rise),
      fmt::format("it rises by a factor of {}, paired over {} persons", to_text(rise), rise.count)};
  Chart chart{"", "error of a grasp, rad²", table.columns, false, true, {{"error", {}}}};
  for (std::size_t i = 0; i < table.columns.size(); ++i)
    chart.series[0].points.push_back(
        {static_cast<double>(i), statistics::geometric_mean(table[table.columns[i]])});
  return {{finding}, chart};
}

}  // namespace

Experiment direct_grasps() {
  return {"6.2",
          "Direct mapping on precision grasps of cylinders, Barrett",
          "Seven basic postures and one precision grasp of each cylinder but one, in turn, by one "
          "person, four hidden neurons, RPROP, 1000 epochs; then the same grasps in a new take",
          {"barrett"},
          {"trained", "new take"},
          100,
          1000,
          direct_grasp_row,
          judge_direct_grasp};
}

}  // namespace prehend::mapping
