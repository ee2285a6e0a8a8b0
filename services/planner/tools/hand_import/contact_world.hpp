#pragma once

#include <vector>

#include "common/model/hand_model.hpp"

namespace prehend::planner {

inline std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

/// What is held in the search for a grasp: a rod along x of its frame R, in the hand's base B. m.
struct Rod {
  Pose X_BR = Pose::Identity();
  double radius = 0.02, half_length = 0.03;
};

/// A link that a rod touches. normal_R: from the rod's axis to the link, at right angles to it.
struct Touch {
  int link = 0, finger = -1;  // -1: palm
  bool last = false;          // the link is the finger's last
  bool presses = true;        // something behind it can still close
  Eigen::Vector3d normal_R;
};

/// The hand's shapes and a rod, without forces: fingers close until they touch. Much faster than
/// the physics, so that thousands of postures can be looked at.
class ContactWorld {
 public:
  /// closing: of each DoF. fingers: the last link of each. Keeps a reference to the hand.
  ContactWorld(const model::HandModel& hand, std::vector<int> closing,
               const std::vector<int>& fingers);

  /// Of the hand in this posture to the rod, m; negative if they overlap, at most `most`.
  double room(const Eigen::VectorXd& dof, const Rod& rod, double most = 0.05) const;
  /// Closes from there until each finger has met the rod or its end, and says what touches.
  std::vector<Touch> close(Eigen::VectorXd dof, const Rod& rod) const;
  /// How deep parts of different fingers reach into each other, m; negative when all are apart, at
  /// least `least`.
  double overlap_of_fingers(const Eigen::VectorXd& dof, double least = -0.005) const;
  /// The point of the palm that is nearest to p_B.
  Eigen::Vector3d nearest_of_palm(const Eigen::VectorXd& dof, const Eigen::Vector3d& p_B) const;

  const model::HandModel& hand() const { return hand_; }
  const std::vector<int>& closing() const { return closing_; }
  /// The finger that a link belongs to; -1: palm, or of several.
  int finger_of(int link) const { return finger_[static_cast<std::size_t>(link)]; }

 private:
  struct Part {
    int link;
    model::Shape shape;
    Pose X_LS;
    double radius;  // of the ball around it
  };
  struct Nearest {
    double distance;
    Eigen::Vector3d normal_R;
  };
  Nearest nearest(const Part& part, const std::vector<Pose>& X_BL, const Rod& rod,
                  double most) const;

  const model::HandModel& hand_;
  std::vector<int> closing_;
  std::vector<int> finger_;                 // of each link
  std::vector<bool> last_;                  // of each link
  std::vector<std::vector<int>> moved_by_;  // closing DoFs that move each link
  std::vector<Part> parts_;
};

/// How well touches hold a rod across its axis, with friction 0.6: the least of the greatest force
/// that any of them has against a pull, over all directions; 0.6 for two that face each other. 0 or
/// less: does not hold.
double grip_quality(const std::vector<Touch>& touches);

}  // namespace prehend::planner
