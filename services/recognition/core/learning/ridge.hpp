#pragma once

#include <Eigen/Core>
#include <vector>

namespace prehend::recognition {

/// k(a, b) = exp(sharpness (similarity - 1)).
Eigen::MatrixXf kernel_of(const Eigen::MatrixXf& similarities, double sharpness);

/// Kernel ridge regression on the classes' indicators: views by classes, over the views whose `use`
/// is set; rows of the others stay zero. A view of class -1 indicates none.
Eigen::MatrixXf solve_ridge(const Eigen::MatrixXf& kernel, const std::vector<int>& view_class,
                            int classes, const std::vector<char>& use);

}  // namespace prehend::recognition
