#pragma once

#include <vector>

#include "services/recognition/core/descriptor/palette.hpp"
#include "services/recognition/core/learning/training.hpp"

namespace prehend::recognition {

/// A fold (0 to folds - 1) for every view of every class, class by class, such that views before
/// the same background share one: neighbouring shots of one scene in training and test flatter.
/// The colour histograms of the pictures' borders (the outer 15 %) are clustered class by class by
/// Ward's method into as many groups as there are folds; the larger a group, the earlier it chooses
/// the fold that has fewest views so far. A class of one view is never tested by itself: its one
/// fold leaves it without any.
std::vector<int> folds_by_background(const std::vector<TrainingClass>& classes, int folds);

/// Ward's method: joins the two clusters of columns whose joining adds least to the sum of squared
/// distances to the centres, until `clusters` are left. The cluster of each column.
std::vector<int> ward(const Eigen::MatrixXf& columns, int clusters);

}  // namespace prehend::recognition
