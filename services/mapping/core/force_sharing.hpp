#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "common/model/hand_model.hpp"
#include "common/model/shape.hpp"
#include "services/mapping/core/finger_distances.hpp"

namespace prehend::mapping {

/// An object as a robot hand believes it to be between its fingers.
struct GrippedObject {
  model::Shape shape;
  Pose X_BO = Pose::Identity();
};

struct ForceSharingOptions {
  /// Friction that fingers are believed to have on anything.
  double friction = 0.6;
  /// A link touches when it is no farther from the object than the nearest of its finger and this, m.
  double within = 0.005;
};

/// How strongly each finger must press so that together they push an object nowhere: the internal
/// force that stays farthest inside the friction cones, as strong as the drives allow. Keeps a
/// reference to the hand.
class ForceSharing {
 public:
  explicit ForceSharing(const model::HandModel& hand, const ForceSharingOptions& options = {});

  /// Of each DoF the share of its full effort, −1 (opens) to 1 (closes); 0 for fingers that do not
  /// press and for what does not close. Nothing when these fingers cannot squeeze: they press from
  /// one side only. pressing: of each finger. object: none where none is known.
  std::optional<Eigen::VectorXd> shares(const Eigen::VectorXd& dof,
                                        const std::vector<bool>& pressing,
                                        const std::optional<GrippedObject>& object) const;

 private:
  std::vector<FingerTouch> touches(const Eigen::VectorXd& dof, const std::vector<bool>& pressing,
                                   const std::optional<GrippedObject>& object) const;

  const model::HandModel& hand_;
  FingerDistances distances_;
  ForceSharingOptions options_;
  Eigen::MatrixXd coupling_;  // joints x DoFs
  Eigen::VectorXd effort_;    // of each DoF at most, N m or N
};

}  // namespace prehend::mapping
