#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "services/planner/tools/hand_import/contact_world.hpp"

namespace prehend::planner {

/// A posture from which fingers close on what lies between them, and where that is.
struct Opposition {
  Pose X_BG = Pose::Identity();  // z out of the palm, y from the thumb's side to the fingers'
  Eigen::VectorXd open;          // values of the DoFs before closing
  double quality = 0;            // of the grips on rods of three sizes, see grip_quality()
  double opening = 0;            // m, of the widest rod that is gripped
  double depth = 0;              // m, from the origin of G to the palm
  /// The finger that stands alone against all others that touch; -1: none does.
  int alone = -1;
  /// Other postures from which what lies there is gripped: «tripod», «pinch».
  std::map<std::string, Eigen::VectorXd> preshapes;
};

/// What is known of the fingers before.
struct Fingers {
  std::vector<int> last;              // the last link of each
  std::vector<Eigen::Vector3d> p_LT;  // the tip of each, in that link's frame
  Eigen::VectorXd open, fist;         // values of all DoFs
  std::vector<bool> fixed;            // of each DoF: moves the whole palm, as a wrist
};

/// How long is searched: the defaults find what more would not improve on the hands under test.
struct SearchEffort {
  int samples = 1500;    // random postures
  int refinements = 60;  // steps of each of the best
  int shapings = 250;    // postures tried for each preshape
  double step = 0.001;   // m, from one radius to the next when the opening is measured
  /// The best are also tried in the physics, see trial_grasps(), and that counts: half a minute.
  bool trials = false;
};

/// How much is held by a hand of this posture and place. Less than `needed` need not be exact.
using OppositionJudge = std::function<double(const Opposition&, double needed)>;

/// Searches the postures of what does not close (opposition of the thumb, abduction, spread) and
/// the places between fingers that can meet: rods are gripped best there, and the hand can come
/// around them along z. X_BG_known is kept, with the posture `open`, unless something clearly
/// better is found. Of the best, that counts which the judge says holds clearly most. The same
/// answer each time.
Opposition find_opposition(const ContactWorld& world, const Fingers& fingers,
                           const Pose& X_BG_known, const SearchEffort& effort = {},
                           const OppositionJudge& judge = {});

}  // namespace prehend::planner
