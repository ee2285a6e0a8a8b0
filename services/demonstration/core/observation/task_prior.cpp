#include "services/demonstration/core/observation/task_prior.hpp"

#include <algorithm>

namespace prehend::demonstration {

namespace {

constexpr double unshown = 1;  // times that each kind counts as shown before anybody showed it

}  // namespace

Eigen::VectorXd task_prior(const std::vector<std::string>& kinds,
                           const model::GraspTaxonomy& taxonomy,
                           const std::vector<model::ObjectPart>& keep_free,
                           const std::vector<tasks::ShownTask>& shown, const std::string& object) {
  Eigen::VectorXd made =
      Eigen::VectorXd::Constant(static_cast<Eigen::Index>(kinds.size()), unshown);
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    double& own = made[static_cast<Eigen::Index>(k)];
    for (const tasks::ShownTask& task : shown)
      own += static_cast<double>(
          std::count_if(task.begin(), task.end(), [&](const tasks::ShownStep& step) {
            return step.object == object && step.grasp == kinds[k];
          }));
    const model::GraspClass* known = taxonomy.find(kinds[k]);
    if (known && std::any_of(keep_free.begin(), keep_free.end(),
                             [&](model::ObjectPart part) { return known->blocked(part); }))
      own = 0;
  }
  return made / std::max(1.0, made.sum());
}

}  // namespace prehend::demonstration
