#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "common/base/time.hpp"
#include "common/model/hand_model.hpp"

namespace prehend::robot {

/// Where two hands that are told the same part: a DoF that differs by more than it may, for longer
/// than latencies explain. Pure. Keeps a reference to the hand.
class Parting {
 public:
  struct Options {
    double within = 0.1;                                 // rad, or what stands for it (radian_of)
    Duration patience = std::chrono::milliseconds(300);  // that it may differ by more
  };
  struct Dof {
    double worst = 0;                // rad or m, of the difference
    std::optional<Time> parted;      // when it began to differ so, for the first time
    bool apart = false;              // now
    std::optional<Time> since = {};  // it differs by more than it may
  };

  Parting(const model::HandModel& hand, const Options& options);

  /// Both at the same time; rad or m. The DoFs that have parted by this.
  std::vector<std::size_t> compare(const Eigen::VectorXd& one, const Eigen::VectorXd& other,
                                   Time now);

  const std::vector<Dof>& dofs() const { return dofs_; }
  int compared() const { return compared_; }
  bool parted() const;  // ever

 private:
  const model::HandModel& hand_;
  Options options_;
  std::vector<Dof> dofs_;
  int compared_ = 0;
};

}  // namespace prehend::robot
