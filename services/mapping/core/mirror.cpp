#include "services/mapping/core/mirror.hpp"

namespace prehend::mapping {
namespace {

const Eigen::DiagonalMatrix<double, 3> S(-1, 1, 1);

/// In the frame of what is its own mirror image.
Pose mirrored(Pose X) {
  X.linear() = S * X.linear() * S;
  X.translation() = S * X.translation();
  return X;
}

}  // namespace

Pose Mirror::pose(const Pose& X_W) const {
  Pose image = mirrored(X_W);
  image.translation().x() += 2 * x_W_;
  return image;
}

Detection Mirror::detection(Detection detection) const {
  detection.X_WO = pose(detection.X_WO);
  // Of x, y, z and the turn about z, x and the turn change their signs.
  const Eigen::DiagonalMatrix<double, 4> signs(-1, 1, 1, -1);
  detection.covariance = signs * detection.covariance * signs;
  return detection;
}

RobotState Mirror::state(RobotState state) const {
  state.X_WB = pose(state.X_WB);
  return state;
}

std::vector<Capsule> Mirror::capsules(std::vector<Capsule> in_W) const {
  for (Capsule& one : in_W)
    for (Eigen::Vector3d* p : {&one.a, &one.b}) p->x() = 2 * x_W_ - p->x();
  return in_W;
}

Command Mirror::command(Command command) const {
  command.X_WB = pose(command.X_WB);
  return command;
}

model::GraspCandidates Mirror::candidates(model::GraspCandidates planned) const {
  for (model::GraspCandidate& candidate : planned.candidates) {
    candidate.X_OG = mirrored(candidate.X_OG);
    candidate.X_OR = mirrored(candidate.X_OR);
  }
  return planned;
}

}  // namespace prehend::mapping
