#include "services/mapping/tools/study/grasp_task.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace prehend::mapping {

namespace {

/// A grasp as this person shows it, one pair.
std::optional<learning::Samples> shown_grasp(Demonstrator& person, const RobotGrasp& grasp) {
  const auto human = person.reach(grasp.shape, grasp.X_OG, grasp.type);
  if (!human) return std::nullopt;
  return learning::Samples{person.read(human->closure), grasp.dof};
}

std::optional<std::vector<learning::Samples>> shown_grasps(
    Demonstrator& person, const std::vector<const RobotGrasp*>& grasps) {
  std::vector<learning::Samples> shown;
  for (const RobotGrasp* grasp : grasps) {
    auto one = shown_grasp(person, *grasp);
    if (!one) return std::nullopt;
    shown.push_back(std::move(*one));
  }
  return shown;
}

}  // namespace

std::optional<GraspTask> grasp_task(const Parts& parts, const std::string& hand,
                                    model::ShapeKind shape, GraspType type, std::size_t turn,
                                    std::string_view keep) {
  std::vector<std::string> may_go;
  for (const model::CatalogueObject& object : parts.catalogue.objects())
    if (object.shape.kind == shape && object.name != keep) may_go.push_back(object.name);
  if (may_go.empty()) return std::nullopt;
  const std::string& gone = may_go[turn % may_go.size()];
  GraspTask task;
  for (const RobotGrasp* grasp : grasps_of(parts, hand, shape, type)) {
    if (grasp->object == gone)
      task.left_out = grasp;
    else
      task.trained.push_back(grasp);
  }
  if (task.trained.size() < 2) return std::nullopt;
  return task;
}

std::optional<ShownTask> show(const GraspTask& task, const StudiedHand& hand, std::uint64_t seed) {
  Demonstrator person("one", seed, {});
  const auto basic = hand.scheme.posture_set(7);
  ShownTask shown;
  auto grasps = shown_grasps(person, task.trained);
  if (!grasps) return std::nullopt;
  for (learning::Samples& grasp : *grasps)
    shown.trained.push_back(joined(std::array{show(person, basic), std::move(grasp)}));
  person.new_take();
  auto again = shown_grasps(person, task.trained);
  if (!again) return std::nullopt;
  shown.again = std::move(*again);
  shown.left_out = {Eigen::MatrixXd(feature_count, 0), Eigen::MatrixXd(hand.hand.dofs().size(), 0)};
  if (task.left_out) {
    auto grasp = shown_grasp(person, *task.left_out);
    if (!grasp) return std::nullopt;
    shown.left_out = std::move(*grasp);
  }
  return shown;
}

Eigen::VectorXd thesis_size(const RobotGrasp& grasp) {
  return Eigen::VectorXd::Constant(1, model::characteristic_size(grasp.shape));
}

learning::Samples sized(const std::vector<learning::Samples>& pairs,
                        const std::vector<const RobotGrasp*>& grasps) {
  std::vector<learning::Samples> all;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    all.push_back(with_size(pairs[i], thesis_size(*grasps[i])));
  return joined(all);
}

std::vector<double> over_types(const Table& table, std::string_view what) {
  std::vector<double> sum(static_cast<std::size_t>(table.values.rows()), 0.0), count = sum;
  for (const GraspType type : grasp_types) {
    const auto one = table[fmt::format("{}: {}", to_string(type), what)];
    for (std::size_t i = 0; i < sum.size(); ++i)
      if (std::isfinite(one[i])) {
        sum[i] += one[i];
        ++count[i];
      }
  }
  for (std::size_t i = 0; i < sum.size(); ++i)
    sum[i] = count[i] > 0 ? sum[i] / count[i] : std::numeric_limits<double>::quiet_NaN();
  return sum;
}

}  // namespace prehend::mapping
