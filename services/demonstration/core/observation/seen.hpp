#pragma once

#include <array>
#include <optional>
#include <string>

#include "common/base/pose.hpp"
#include "common/base/time.hpp"
#include "common/model/human_hand.hpp"
#include "common/model/shape.hpp"

namespace prehend::demonstration {

/// A hand at a time. H: the back of the hand.
struct SeenHand {
  Time stamp{};
  Pose X_WH = Pose::Identity();
  double scale = 1;  // length of the hand relative to an average one
  std::array<std::optional<Eigen::Vector3d>, model::finger_count>
      p_HF;  // fingertips, as far as seen
};

/// An object at a time.
struct SeenObject {
  Time stamp{};
  std::string name;
  model::Shape shape;
  Pose X_WO = Pose::Identity();
};

}  // namespace prehend::demonstration
