#pragma once

#include <optional>
#include <vector>

#include "services/mapping/tools/study/experiment.hpp"
#include "services/mapping/tools/study/imitation.hpp"

namespace prehend::mapping {

/// Training and testing one network a shape and grasp type, as in [Thesis, chapter 6]: for each
/// object the seven basic postures and one grasp. The shape's objects take turns in being left out.
struct GraspTask {
  std::vector<const RobotGrasp*> trained;
  const RobotGrasp* left_out = nullptr;  // none where the hand cannot grasp it
};

/// turn: whose turn it is to be left out; never that of `keep`. None when fewer than two objects
/// remain that the hand grasps so.
std::optional<GraspTask> grasp_task(const Parts& parts, const std::string& hand,
                                    model::ShapeKind shape, GraspType type, std::size_t turn,
                                    std::string_view keep = {});

/// What one person shows for it: the pairs of each object, without size.
struct ShownTask {
  std::vector<learning::Samples> trained;  // of each trained object: postures, then the grasp
  std::vector<learning::Samples> again;    // the grasps alone, in a new take
  learning::Samples left_out;  // the grasp of the object that was left out; no pairs without one
};

/// The person follows from the seed. None when this hand does not fit around one of the objects.
std::optional<ShownTask> show(const GraspTask& task, const StudiedHand& hand, std::uint64_t seed);

/// Size as in [Thesis, 5.3]: radius, or a box's depth, m.
Eigen::VectorXd thesis_size(const RobotGrasp& grasp);

/// Pairs of all objects of a list, each with its size.
learning::Samples sized(const std::vector<learning::Samples>& pairs,
                        const std::vector<const RobotGrasp*>& grasps);

/// Of columns «TYPE: WHAT»: the mean over the grasp types that were measured, repetition by
/// repetition; not-a-number where none was.
std::vector<double> over_types(const Table& table, std::string_view what);

}  // namespace prehend::mapping
