#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/grasping/world.hpp"

namespace prehend::simulation {

/// What a link of the hand feels, as a pad of sensors all over it would. B: the hand's base.
struct PadTouch {
  bool touching = false;
  Eigen::Vector3d force_B = Eigen::Vector3d::Zero();  // N, on the link: pressure and friction
  double pressure = 0;                                // N, of it, into the link
  Eigen::Vector3d p_BC = Eigen::Vector3d::Zero();     // m, where it presses in the mean
  double slip = 0;          // m/s, at which what touches slides along the link
  double friction_use = 0;  // of the friction that the pressure allows, 0 to 1
  bool slipping = false;
};

/// Forces of the world's solver jump from step to step; what a sensor tells does not. Forces are
/// filtered (20 ms), that something touches is not. A pad slips when what touches it has slid at
/// more than 5 mm/s for 10 ms.
class TouchSense {
 public:
  /// hand: its number in the world.
  TouchSense(std::size_t links, double time_step, int hand = 0);

  /// After each step of the world, with World::touches().
  void update(const std::vector<grasping::Touch>& touches, const Pose& X_WB);
  /// Of each link, in the order of the hand's description.
  const std::vector<PadTouch>& pads() const { return pads_; }

 private:
  double time_step_;
  int hand_;
  std::vector<PadTouch> pads_;
  std::vector<double> allowed_;  // N, of friction, filtered as the force is
  std::vector<double> slid_;     // s, for which it has
};

}  // namespace prehend::simulation
