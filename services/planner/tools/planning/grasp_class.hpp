#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "common/analysis/contact.hpp"
#include "common/base/error.hpp"
#include "common/model/grasp_taxonomy.hpp"
#include "common/model/hand_model.hpp"
#include "common/model/shape.hpp"

namespace prehend::planner {

/// What a robot's grasp looks like, and which kind of human grasp that is.
struct GraspLooks {
  bool enclosed = false;  // more than fingertips touch
  int fingers = 0;        // that touch
  double opposing = 0;    // 0: all press the same way, 1: forces are in balance
  double around = 0;      // 0: fingers press along one line, 1: alike in all directions of a plane
  double width = 0;       // m, between what presses
  model::GraspKind kind{};
  model::GraspForm form{};
  std::string name;  // of the class in the taxonomy
};

/// By where a hand touches: enclosed is a power grasp; pressed around the line along which the palm
/// has come is circular, in one direction prismatic, from one side only flat. Among the classes of
/// that kind and form the one of as many fingers, such a shape and such a width. approach_O: out of
/// the palm. Adducted thumbs cannot be seen in a robot hand: those classes are never the answer.
/// Fails without contacts, on links that the hand has not, and when no class is of the kind.
Expected<GraspLooks> looks_of(const model::HandModel& hand,
                              const std::vector<analysis::Contact>& contacts,
                              const Eigen::Vector3d& approach_O,
                              const std::optional<model::Shape>& shape,
                              const model::GraspTaxonomy& taxonomy);

}  // namespace prehend::planner
