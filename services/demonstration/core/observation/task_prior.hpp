#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/model/grasp_taxonomy.hpp"
#include "services/demonstration/core/tasks/learn_task.hpp"

namespace prehend::demonstration {

/// P(kind of grasp | task) for one object, but for a common factor: how often each kind was shown
/// for it in this task before, where what was not shown stays possible; 0 for a kind that lies on
/// what the task needs free. In the order of `kinds`; a kind that the taxonomy does not know lies
/// on nothing.
Eigen::VectorXd task_prior(const std::vector<std::string>& kinds,
                           const model::GraspTaxonomy& taxonomy,
                           const std::vector<model::ObjectPart>& keep_free,
                           const std::vector<tasks::ShownTask>& shown, const std::string& object);

}  // namespace prehend::demonstration
