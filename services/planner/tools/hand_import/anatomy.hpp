#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/model/hand_model.hpp"
#include "services/planner/tools/hand_import/opposition.hpp"
#include "services/planner/tools/hand_import/robot.hpp"

namespace prehend::planner {

/// What a hand.toml says of a hand, found from its URDF alone.
struct Anatomy {
  struct Dof {
    std::string joint;
    int closing = 0;
    double open = 0, fist = 0;
    bool wrist = false;  // moves the whole palm
    model::Coupling coupling = model::Coupling::springs;
  };
  struct Fingertip {
    std::string name, link;
    Eigen::Vector3d p_LT;
    std::optional<model::Finger> human;  // as a person says
  };
  std::vector<Dof> dofs;  // one a joint that does not mimic, in the order of the tree
  std::vector<Fingertip> fingertips;
  Pose X_BG = Pose::Identity();
  model::Reach reach;
  std::map<std::string, Eigen::VectorXd> preshapes;  // besides «open»
  std::vector<std::string> thumb_joints;  // of the finger that stands against two or more others
  bool opposed = true;  // false: no fingers that move towards each other were found
};

/// How much is held by a hand of which this is said. Less than `needed` need not be exact.
using AnatomyJudge = std::function<double(const Anatomy&, double needed)>;

/// Tells fingers and palm apart (skeleton.hpp), which way they close (closing.hpp), where they
/// grasp (grasp_frame.hpp) and what they can hold (opposition.hpp). robot: as repair() made it.
Expected<Anatomy> find_anatomy(const Robot& robot, const SearchEffort& effort = {},
                               const AnatomyJudge& judge = {});

}  // namespace prehend::planner
