// V4L2 devices, through OpenCV.
#include <algorithm>
#include <cctype>
#include <chrono>
#include <opencv2/videoio.hpp>

#include "services/recognition/cameras/frame.hpp"
#include "services/recognition/cameras/sources.hpp"

namespace prehend::recognition {
namespace {

bool is_number(const std::string& text) {
  return !text.empty() && text.size() < 4 &&
         std::all_of(text.begin(), text.end(),
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

class Device final : public Camera {
 public:
  explicit Device(CameraOptions options) : options_(std::move(options)) {
    if (options_.path.empty()) options_.path = "/dev/video0";
  }

  Expected<void> open() {
    try {
      if (is_number(options_.path))
        capture_.open(std::stoi(options_.path), cv::CAP_V4L2);
      else
        capture_.open(options_.path, cv::CAP_V4L2);
      if (capture_.isOpened()) {
        capture_.set(cv::CAP_PROP_FRAME_WIDTH, options_.model.width);
        capture_.set(cv::CAP_PROP_FRAME_HEIGHT, options_.model.height);
        capture_.set(cv::CAP_PROP_FPS, options_.rate);
        capture_.set(cv::CAP_PROP_BUFFERSIZE, 1);
      }
    } catch (const cv::Exception&) {
      capture_.release();
    }
    if (capture_.isOpened()) return {};
    return fail("no camera answers", "device " + options_.path,
                "is it plugged in, and are you in the group video?");
  }

  Expected<Picture> next() override {
    if (!capture_.isOpened())
      if (auto opened = open(); !opened) return tl::unexpected(opened.error());
    cv::Mat image;
    bool good = false;
    try {
      good = capture_.read(image) && !image.empty();
    } catch (const cv::Exception&) {
    }
    if (!good) {
      capture_.release();
      return fail("the camera stopped", options_.path, "check the cable; it is tried again");
    }
    age_ = since(capture_.get(cv::CAP_PROP_POS_MSEC));
    return to_picture(image, options_.path);
  }
  bool paces_itself() const override { return true; }
  Duration age() const override { return age_; }

 private:
  /// V4L2 stamps a buffer on the monotonic clock, when its exposure has ended.
  static Duration since(double milliseconds) {
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    const auto age = std::chrono::duration_cast<Duration>(now) - seconds(milliseconds / 1000);
    const bool sound = age > Duration::zero() && age < std::chrono::seconds(2);
    return sound ? age : Duration{};
  }

  CameraOptions options_;
  Duration age_{};
  cv::VideoCapture capture_;
};

}  // namespace

// Missing at the start is an error; one that disappears later is waited for.
Expected<std::unique_ptr<Camera>> open_device(const CameraOptions& options) {
  auto camera = std::make_unique<Device>(options);
  if (auto opened = camera->open(); !opened) return tl::unexpected(opened.error());
  return camera;
}

}  // namespace prehend::recognition
