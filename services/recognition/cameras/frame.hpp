#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "common/base/error.hpp"
#include "services/recognition/core/picture/picture.hpp"

namespace prehend::recognition {

/// A frame as OpenCV hands it over, whatever its format: grey, BGR or BGRA, 8 or 16 bits. Fails
/// when it has another one, less than 8 px or more than 40 million.
Expected<Picture> to_picture(const cv::Mat& frame, const std::string& where);

}  // namespace prehend::recognition
