#pragma once

#include <filesystem>

#include "common/base/error.hpp"
#include "services/glove/core/calibration/user_calibration.hpp"

namespace prehend::glove {

/// What is known of a user's hand as a small TOML file named after the user.
Expected<UserCalibration> load_user(const std::filesystem::path& file);
/// Makes the folder where needed.
Expected<void> save(const std::filesystem::path& file, const UserCalibration& user);

}  // namespace prehend::glove
