#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <prehend/base/error.hpp>

namespace prehend::simulation {

/// The wrenches that a file for `prehend grasp quality` speaks of, as columns of six: either
/// {"wrenches":[[6]...]} or {"contacts":[{"position_m","normal","friction","tangent"?}],
/// "center_of_mass_m","torque_scale_m","edges":8}.
Expected<Eigen::MatrixXd> read_wrenches(const std::filesystem::path& file);

}  // namespace prehend::simulation
