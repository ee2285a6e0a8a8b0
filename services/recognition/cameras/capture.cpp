// V4L2 devices, video files and streams, all through OpenCV.
#include <algorithm>
#include <cctype>
#include <chrono>
#include <opencv2/videoio.hpp>

#include "frame.hpp"
#include "sources.hpp"

namespace prehend::recognition {
namespace {

bool is_number(const std::string& text) {
  return !text.empty() && text.size() < 4 &&
         std::all_of(text.begin(), text.end(),
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

class CaptureCamera final : public Camera {
 public:
  CaptureCamera(CameraOptions options, bool device)
      : options_(std::move(options)),
        device_(device),
        file_(!device && options_.path.find("://") == std::string::npos) {}

  Expected<void> open() {
    try {
      if (device_) {
        const int api = cv::CAP_V4L2;
        if (is_number(options_.path))
          capture_.open(std::stoi(options_.path), api);
        else
          capture_.open(options_.path.empty() ? "/dev/video0" : options_.path, api);
        if (capture_.isOpened()) {
          capture_.set(cv::CAP_PROP_FRAME_WIDTH, options_.model.width);
          capture_.set(cv::CAP_PROP_FRAME_HEIGHT, options_.model.height);
          capture_.set(cv::CAP_PROP_FPS, options_.rate);
          capture_.set(cv::CAP_PROP_BUFFERSIZE, 1);
        }
      } else {
        // A stream that stalls is given up after three seconds, and opened anew.
        capture_.open(options_.path, cv::CAP_FFMPEG,
                      {cv::CAP_PROP_OPEN_TIMEOUT_MSEC, 3000, cv::CAP_PROP_READ_TIMEOUT_MSEC, 3000});
      }
    } catch (const cv::Exception&) {
      capture_.release();
    }
    if (capture_.isOpened()) return {};
    return fail(device_ ? "no camera answers" : "cannot be played", where(),
                device_ ? "is it plugged in, and are you in the group video?"
                        : "is it there, and a format that FFmpeg knows?");
  }

  Expected<Picture> next() override {
    if (!capture_.isOpened())
      if (auto opened = open(); !opened) return tl::unexpected(opened.error());
    cv::Mat image;
    bool good = false;
    try {
      good = leave_out() && capture_.read(image) && !image.empty();
    } catch (const cv::Exception&) {
    }
    if (!good) {
      capture_.release();
      finished_ = file_ && seen_;
      return fail(finished_ ? "the video has ended" : "the camera stopped", where(),
                  finished_ ? "" : "check the cable; it is tried again");
    }
    seen_ = true;
    age_ = device_ ? since(capture_.get(cv::CAP_PROP_POS_MSEC)) : Duration{};
    return to_picture(image, where());
  }
  bool finished() const override { return finished_; }
  bool paces_itself() const override { return !file_; }
  Duration age() const override { return age_; }

 private:
  /// Of a file that has more pictures a second than are wanted, those between.
  bool leave_out() {
    const double rate = file_ ? capture_.get(cv::CAP_PROP_FPS) : 0;
    if (!(rate > options_.rate) || rate > 1000) return true;
    for (owed_ += rate / options_.rate; owed_ >= 2; owed_ -= 1)
      if (!capture_.grab()) return false;
    owed_ -= 1;
    return true;
  }
  /// V4L2 stamps a buffer on the monotonic clock, when its exposure has ended.
  static Duration since(double milliseconds) {
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    const auto age = std::chrono::duration_cast<Duration>(now) - seconds(milliseconds / 1000);
    const bool sound = age > Duration::zero() && age < std::chrono::seconds(2);
    return sound ? age : Duration{};
  }

  std::string where() const { return options_.path.empty() ? "/dev/video0" : options_.path; }

  CameraOptions options_;
  bool device_, file_, seen_ = false, finished_ = false;
  double owed_ = 0;  // pictures of the file that are due
  Duration age_{};
  cv::VideoCapture capture_;
};

}  // namespace

namespace {

// Missing at the start is an error; one that disappears later is waited for.
Expected<std::unique_ptr<Camera>> open_capture(const CameraOptions& options, bool device) {
  auto camera = std::make_unique<CaptureCamera>(options, device);
  if (auto opened = camera->open(); !opened) return tl::unexpected(opened.error());
  return camera;
}

}  // namespace

Expected<std::unique_ptr<Camera>> open_device(const CameraOptions& options) {
  return open_capture(options, true);
}

Expected<std::unique_ptr<Camera>> open_video(const CameraOptions& options) {
  return open_capture(options, false);
}

}  // namespace prehend::recognition
