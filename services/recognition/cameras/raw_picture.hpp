#pragma once

#include <string>

#include "common/base/error.hpp"
#include "common/ros2/pictures.hpp"
#include "services/recognition/core/picture/picture.hpp"

namespace prehend::recognition {

/// The colours of a picture that came without a file: rgb8, bgr8, rgba8, bgra8, mono8, mono16,
/// 8UC1, 8UC3 (blue first), bayer_*8 and both yuv422.
/// Refused: other encodings, as those of depth; fewer bytes than rows have; less than 8 px or more
/// than 40 million pixels.
Expected<Picture> picture_of(const ros2::RawPicture& raw, const std::string& where);

}  // namespace prehend::recognition
