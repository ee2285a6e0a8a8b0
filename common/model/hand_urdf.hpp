#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/model/hand_model.hpp"

namespace prehend::model {

/// What a URDF says about a hand. Links joined by fixed joints are one link, named after the one
/// nearest the base.
struct HandTree {
  struct Mimic {
    std::string joint;
    double multiplier = 1, offset = 0;
  };
  std::vector<HandLink> links;               // [0] is the base; no materials yet
  std::vector<HandJoint> joints;             // parents before children; not yet coupled to DoFs
  std::vector<std::optional<Mimic>> mimics;  // of each joint
  std::vector<double> velocities;            // limit of each joint, rad/s or m/s
};

/// Reads revolute, prismatic and fixed joints, and collision shapes that are boxes, cylinders and
/// spheres; refuses everything that it could not represent. Errors name the element.
Expected<HandTree> read_hand_urdf(const std::string& text);

}  // namespace prehend::model
