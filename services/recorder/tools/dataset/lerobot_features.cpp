#include "services/recorder/tools/dataset/lerobot_features.hpp"

namespace prehend::recorder::dataset {
namespace {

using Json = nlohmann::ordered_json;
using Kind = LerobotFeature::Kind;

/// All poses of objects side by side.
LerobotFeature environment(const Rows& rows) {
  LerobotFeature all{"observation.environment_state", Kind::real, {}, Table(rows.count, 0)};
  for (const Feature& feature : rows.others) {
    if (feature.about != About::object) continue;
    for (const std::string& column : feature.columns)
      all.columns.push_back(feature.name + "." + column);
    const Eigen::Index before = all.values.cols();
    all.values.conservativeResize(rows.count, before + feature.values.cols());
    all.values.rightCols(feature.values.cols()) = feature.values;
  }
  return all;
}

LerobotFeature counted(std::string name, Kind kind, Eigen::Index count, double first, double step) {
  LerobotFeature feature{std::move(name), kind, {}, Table(count, 1)};
  for (Eigen::Index row = 0; row < count; ++row)
    feature.values(row, 0) = first + step * static_cast<double>(row);
  return feature;
}

LerobotFeature at_end(std::string name, Kind kind, Eigen::Index count, bool value) {
  LerobotFeature feature = counted(std::move(name), kind, count, 0, 0);
  feature.values(count - 1, 0) = value ? 1 : 0;
  return feature;
}

}  // namespace

std::vector<LerobotFeature> lerobot_features(const RecordedEpisode& recorded, double rate,
                                             const LerobotPlace& place, bool judged) {
  const Rows& rows = recorded.rows;
  std::vector<LerobotFeature> all{
      {"observation.state", Kind::real, rows.state.columns, rows.state.values},
      {"action", Kind::real, rows.action.columns, rows.action.values}};
  for (const Feature& feature : rows.others)
    if (feature.about != About::object)
      all.push_back({"observation." + feature.name, Kind::real, feature.columns, feature.values});
  if (auto objects = environment(rows); !objects.columns.empty()) all.push_back(std::move(objects));
  if (judged) {
    const bool success = recorded.episode.success.value_or(false);
    all.push_back(at_end("next.reward", Kind::real, rows.count, success));
    all.push_back(at_end("next.success", Kind::truth, rows.count, success));
  }
  all.push_back(at_end("next.done", Kind::truth, rows.count, true));
  const auto number = [](std::int64_t value) { return static_cast<double>(value); };
  all.push_back(counted("timestamp", Kind::real, rows.count, 0, 1 / rate));
  all.push_back(counted("frame_index", Kind::whole, rows.count, 0, 1));
  all.push_back(counted("episode_index", Kind::whole, rows.count, number(place.episode), 0));
  all.push_back(counted("index", Kind::whole, rows.count, number(place.first_row), 1));
  all.push_back(counted("task_index", Kind::whole, rows.count, number(place.task), 0));
  return all;
}

Json description(const LerobotFeature& feature) {
  const char* type = feature.kind == Kind::real    ? "float32"
                     : feature.kind == Kind::whole ? "int64"
                                                   : "bool";
  return {{"dtype", type},
          {"shape", {feature.values.cols()}},
          {"names", feature.columns.empty() ? Json() : Json(feature.columns)}};
}

void append(Column& column, const LerobotFeature& feature) {
  if (column.name.empty()) {
    column.name = feature.name;
    // One number is no list to LeRobot.
    if (feature.values.cols() > 1) column.shape = {static_cast<std::size_t>(feature.values.cols())};
    if (feature.kind == Kind::real) column.values = std::vector<float>();
    if (feature.kind == Kind::whole) column.values = std::vector<std::int64_t>();
    if (feature.kind == Kind::truth) column.values = std::vector<bool>();
  }
  const double* first = feature.values.data();
  for (Eigen::Index i = 0; i < feature.values.size(); ++i) {
    if (auto* reals = std::get_if<std::vector<float>>(&column.values))
      reals->push_back(static_cast<float>(first[i]));
    else if (auto* wholes = std::get_if<std::vector<std::int64_t>>(&column.values))
      wholes->push_back(static_cast<std::int64_t>(first[i]));
    else if (auto* truths = std::get_if<std::vector<bool>>(&column.values))
      truths->push_back(first[i] != 0);
  }
}

Json to_json(const Statistics& statistics, bool picture) {
  const auto numbers = [&](const Eigen::VectorXd& values) {
    Json list = Json::array();
    for (const double value : values)
      list.push_back(picture ? Json::array({Json::array({value})}) : Json(value));
    return list;
  };
  return {{"min", numbers(statistics.min)},
          {"max", numbers(statistics.max)},
          {"mean", numbers(statistics.mean)},
          {"std", numbers(statistics.deviation)},
          {"count", {statistics.count}}};
}

void append(std::vector<Column>& row, const std::string& name, const Statistics& statistics,
            bool picture) {
  const auto add = [&](const char* what, const Eigen::VectorXd& values) {
    std::vector<std::size_t> shape{static_cast<std::size_t>(values.size())};
    if (picture) shape.insert(shape.end(), {1, 1});
    row.push_back(
        {"stats/" + name + "/" + what, shape, std::vector<double>(values.begin(), values.end())});
  };
  add("min", statistics.min);
  add("max", statistics.max);
  add("mean", statistics.mean);
  add("std", statistics.deviation);
  row.push_back({"stats/" + name + "/count",
                 {1},
                 std::vector<std::int64_t>{static_cast<std::int64_t>(statistics.count)}});
}

}  // namespace prehend::recorder::dataset
