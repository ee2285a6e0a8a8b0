// Figures 6.6 and 6.8: an intelligent network is told a wrong size.
#include <fmt/format.h>

#include <limits>

#include "common/statistics/intervals.hpp"
#include "services/mapping/tools/study/grasp_task.hpp"

namespace prehend::mapping {

namespace {

struct WrongSize {
  std::string figure, hand;
  model::ShapeKind shape;
  int hidden;  // the choice of [Thesis, 5.2.2] for the hand
};

constexpr std::array told_sizes{"right size", "told the smallest"};

std::string size_column(GraspType type, std::string_view size) {
  return fmt::format("{}: {}", to_string(type), size);
}

/// Mean distance of the fingertips from where the demonstrated grasp has them, mm.
double fingertip_error(const model::HandModel& hand, const Eigen::VectorXd& dof,
                       const Eigen::VectorXd& expected) {
  const auto a = hand.fingertip_positions(hand.clamp(dof)), b = hand.fingertip_positions(expected);
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).norm();
  return 1000 * sum / static_cast<double>(a.size());
}

Eigen::VectorXd row(const WrongSize& what, const Parts& parts, const Repetition& repetition) {
  Eigen::VectorXd errors = Eigen::VectorXd::Constant(grasp_types.size() * told_sizes.size(),
                                                     std::numeric_limits<double>::quiet_NaN());
  const StudiedHand& hand = parts.hand(what.hand);
  for (std::size_t t = 0; t < grasp_types.size(); ++t) {
    const GraspTask task{grasps_of(parts, what.hand, what.shape, grasp_types[t]), nullptr};
    if (task.trained.size() < 2) continue;
    const auto shown = show(task, hand, repetition.seed);
    if (!shown) continue;
    ImitationOptions options;
    options.hidden = what.hidden;
    options.seed = repetition.seed;
    const auto made = Imitation::fit(sized(shown->trained, task.trained), options);
    if (!made) continue;
    std::size_t largest = 0, smallest = 0;
    const auto size = [&](std::size_t i) { return thesis_size(*task.trained[i])[0]; };
    for (std::size_t i = 1; i < task.trained.size(); ++i) {
      if (size(i) > size(largest)) largest = i;
      if (size(i) < size(smallest)) smallest = i;
    }
    for (std::size_t k = 0; k < told_sizes.size(); ++k) {
      const auto asked =
          with_size(shown->again[largest], thesis_size(*task.trained[k == 0 ? largest : smallest]));
      errors[static_cast<Eigen::Index>(t * told_sizes.size() + k)] =
          fingertip_error(hand.hand, made->answer(asked.inputs.col(0)), asked.outputs.col(0));
    }
  }
  return errors;
}

Outcome judge(const WrongSize& what, const std::string& claim, const Table& table) {
  const auto right = over_types(table, told_sizes[0]), wrong = over_types(table, told_sizes[1]);
  const statistics::Interval ratio = statistics::paired_ratio(wrong, right);
  const Finding finding{
      what.figure, claim,
      fmt::format("fingertips off by {} mm with the right size and by {} mm with the wrong one",
                  to_text(statistics::geometric_mean(right)),
                  to_text(statistics::geometric_mean(wrong))),
      above_one(ratio),
      fmt::format("the latter is {} times the former, paired over {} persons", to_text(ratio),
                  ratio.count)};
  Chart chart{"", "fingertips off by, mm", {}, false, false, {}};
  for (const GraspType type : grasp_types) chart.names.emplace_back(to_string(type));
  for (const char* size : told_sizes) {
    ChartSeries series{size, {}};
    for (std::size_t t = 0; t < grasp_types.size(); ++t)
      series.points.push_back(
          {static_cast<double>(t),
           statistics::geometric_mean(table[size_column(grasp_types[t], size)])});
    chart.series.push_back(std::move(series));
  }
  return {{finding}, chart};
}

Experiment wrong_size(const WrongSize& what, std::string title, const std::string& claim) {
  std::vector<std::string> columns;
  for (const GraspType type : grasp_types)
    for (const char* size : told_sizes) columns.push_back(size_column(type, size));
  return {
      what.figure,
      std::move(title),
      "The largest object that the hand can grasp is grasped in a new take; the network is told "
      "its size or that of the smallest. Fingertips by the robot's kinematics",
      {what.hand},
      std::move(columns),
      100,
      1000,
      [what](const Parts& parts, const Repetition& repetition) {
        return row(what, parts, repetition);
      },
      [what, claim](const Table& table) { return judge(what, claim, table); }};
}

}  // namespace

Experiment wrong_radius() {
  return wrong_size({"6.6", "dlr", model::ShapeKind::cylinder, 8},
                    "A cylinder's radius told wrong, DLR",
                    "DLR, cylinders: a wrong size at the input gives imprecise fingertips");
}

Experiment wrong_depth() {
  return wrong_size({"6.8", "robonaut", model::ShapeKind::box, 9},
                    "A box's depth told wrong, Robonaut",
                    "Robonaut: a large box told as small gives imprecise fingertips");
}

}  // namespace prehend::mapping
