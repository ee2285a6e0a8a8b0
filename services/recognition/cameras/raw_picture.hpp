#pragma once

#include <string>

#include "common/base/error.hpp"
#include "common/ros2/pictures.hpp"
#include "services/recognition/core/picture/picture.hpp"

namespace prehend::recognition {

/// The colours of a picture that came without a file. Refused: what `pixels_of` refuses, less than
/// 8 px and more than 40 million pixels.
Expected<Picture> picture_of(const ros2::RawPicture& raw, const std::string& where);

}  // namespace prehend::recognition
