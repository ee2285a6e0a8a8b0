#include "services/robot/core/parting.hpp"

#include <algorithm>
#include <cmath>

namespace prehend::robot {

Parting::Parting(const model::HandModel& hand, const Options& options)
    : hand_(hand), options_(options), dofs_(hand.dofs().size()) {}

std::vector<std::size_t> Parting::compare(const Eigen::VectorXd& one, const Eigen::VectorXd& other,
                                          Time now) {
  ++compared_;
  std::vector<std::size_t> parted;
  for (std::size_t d = 0; d < dofs_.size(); ++d) {
    Dof& dof = dofs_[d];
    const auto i = static_cast<Eigen::Index>(d);
    const double difference = std::abs(one[i] - other[i]);
    dof.worst = std::max(dof.worst, difference);
    if (difference <= options_.within * model::radian_of(hand_.dofs()[d])) {
      dof.since.reset();
      dof.apart = false;
      continue;
    }
    if (!dof.since) dof.since = now;
    if (dof.apart || now - *dof.since < options_.patience) continue;
    dof.apart = true;
    if (!dof.parted) dof.parted = dof.since;
    parted.push_back(d);
  }
  return parted;
}

bool Parting::parted() const {
  return std::any_of(dofs_.begin(), dofs_.end(), [](const Dof& dof) { return dof.parted; });
}

}  // namespace prehend::robot
