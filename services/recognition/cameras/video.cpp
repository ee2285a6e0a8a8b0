// Video files and streams, through FFmpeg itself: OpenCV's capture does not see that a stream's
// pictures change their size, and goes on handing over the last one that had the first size.
extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/display.h>
#include <libswscale/swscale.h>
}

#include <chrono>
#include <cmath>
#include <opencv2/core.hpp>

#include "services/recognition/cameras/frame.hpp"
#include "services/recognition/cameras/sources.hpp"

namespace prehend::recognition {
namespace {

struct Free {
  void operator()(AVFormatContext* context) const { avformat_close_input(&context); }
  void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
  void operator()(SwsContext* context) const { sws_freeContext(context); }
};
template <typename T>
using Owned = std::unique_ptr<T, Free>;

class Video final : public Camera {
 public:
  explicit Video(CameraOptions options)
      : options_(std::move(options)), file_(options_.path.find("://") == std::string::npos) {
    av_log_set_level(AV_LOG_FATAL);  // what goes wrong is said by our errors
  }

  Expected<void> open() {
    if (start()) return {};
    stop();
    return fail("cannot be played", options_.path, "is it there, and a format that FFmpeg knows?");
  }

  Expected<Picture> next() override {
    if (!decoder_)
      if (auto opened = open(); !opened) return tl::unexpected(opened.error());
    if (!leave_out() || !read()) {
      stop();
      finished_ = file_ && seen_;
      return fail(finished_ ? "the video has ended" : "the camera stopped", options_.path,
                  finished_ ? "" : "check the cable; it is tried again");
    }
    seen_ = true;
    return picture();
  }
  bool finished() const override { return finished_; }
  bool paces_itself() const override { return !file_; }

 private:
  /// A stream that stalls is given up after three seconds, and opened anew.
  void begin_to_wait() { give_up_ = std::chrono::steady_clock::now() + std::chrono::seconds(3); }
  static int too_late(void* self) {
    return std::chrono::steady_clock::now() > static_cast<Video*>(self)->give_up_;
  }

  bool start() {
    begin_to_wait();
    AVFormatContext* opened = avformat_alloc_context();
    if (opened == nullptr) return false;
    opened->interrupt_callback = {&Video::too_late, this};
    AVDictionary* wishes = nullptr;
    av_dict_set(&wishes, "rtsp_transport", "tcp", 0);
    const int answer = avformat_open_input(&opened, options_.path.c_str(), nullptr, &wishes);
    av_dict_free(&wishes);
    if (answer < 0) return false;  // and `opened` is freed
    container_.reset(opened);
    if (avformat_find_stream_info(opened, nullptr) < 0) return false;
    const AVCodec* codec = nullptr;
    const int index = av_find_best_stream(opened, AVMEDIA_TYPE_VIDEO, -1, -1, &codec, 0);
    if (index < 0) return false;
    stream_ = opened->streams[index];
    decoder_.reset(avcodec_alloc_context3(codec));
    return decoder_ && packet_ && frame_ &&
           avcodec_parameters_to_context(decoder_.get(), stream_->codecpar) >= 0 &&
           avcodec_open2(decoder_.get(), codec, nullptr) >= 0;
  }
  void stop() {
    decoder_.reset();
    container_.reset();
  }

  /// Decodes the next frame; false at the end, and when none comes in time.
  bool read() {
    begin_to_wait();
    while (true) {
      const int decoded = avcodec_receive_frame(decoder_.get(), frame_.get());
      if (decoded == 0) return true;
      if (decoded == AVERROR_EOF) return false;
      const int got = av_read_frame(container_.get(), packet_.get());
      if (got == AVERROR(EAGAIN) && !too_late(this)) continue;
      if (got < 0) {  // what the decoder still holds is to come
        avcodec_send_packet(decoder_.get(), nullptr);
        continue;
      }
      // A damaged packet is passed over.
      if (packet_->stream_index == stream_->index)
        avcodec_send_packet(decoder_.get(), packet_.get());
      av_packet_unref(packet_.get());
    }
  }
  /// Of a file that has more pictures a second than are wanted, those between.
  bool leave_out() {
    const AVRational guess = av_guess_frame_rate(container_.get(), stream_, nullptr);
    const double rate = file_ && guess.den > 0 ? av_q2d(guess) : 0;
    if (!(rate > options_.rate) || rate > 1000) return true;
    for (owed_ += rate / options_.rate; owed_ >= 2; owed_ -= 1)
      if (!read()) return false;
    owed_ -= 1;
    return true;
  }

  /// The frame, of whatever size, upright.
  Expected<Picture> picture() {
    const auto unreadable = [&] { return fail("a picture cannot be read", options_.path); };
    const int width = frame_->width, height = frame_->height;
    if (!bgr_ || bgr_->width != width || bgr_->height != height) {
      bgr_.reset(av_frame_alloc());
      if (!bgr_) return unreadable();
      bgr_->format = AV_PIX_FMT_BGR24;
      bgr_->width = width;
      bgr_->height = height;
      if (av_frame_get_buffer(bgr_.get(), 0) < 0) return unreadable();
    }
    scaler_.reset(sws_getCachedContext(scaler_.release(), width, height,
                                       static_cast<AVPixelFormat>(frame_->format), width, height,
                                       AV_PIX_FMT_BGR24, SWS_BICUBIC, nullptr, nullptr, nullptr));
    if (!scaler_ || sws_scale(scaler_.get(), frame_->data, frame_->linesize, 0, height, bgr_->data,
                              bgr_->linesize) != height)
      return unreadable();
    cv::Mat image(height, width, CV_8UC3, bgr_->data[0],
                  static_cast<std::size_t>(bgr_->linesize[0]));
    switch (quarter_turns()) {
      case 1:
        cv::rotate(image, image, cv::ROTATE_90_COUNTERCLOCKWISE);
        break;
      case 2:
        cv::rotate(image, image, cv::ROTATE_180);
        break;
      case 3:
        cv::rotate(image, image, cv::ROTATE_90_CLOCKWISE);
        break;
      default:
        break;
    }
    return to_picture(image, options_.path);
  }
  /// By which it is to be turned counterclockwise, as telephones write it: 0 to 3.
  int quarter_turns() const {
#if LIBAVFORMAT_VERSION_MAJOR >= 61  // moved there; the old place is deprecated
    const AVCodecParameters& codec = *stream_->codecpar;
    const AVPacketSideData* side = av_packet_side_data_get(
        codec.coded_side_data, codec.nb_coded_side_data, AV_PKT_DATA_DISPLAYMATRIX);
    const std::uint8_t* matrix = side == nullptr ? nullptr : side->data;
#else
    const std::uint8_t* matrix =
        av_stream_get_side_data(stream_, AV_PKT_DATA_DISPLAYMATRIX, nullptr);
#endif
    if (matrix == nullptr) return 0;
    const double turn = av_display_rotation_get(reinterpret_cast<const std::int32_t*>(matrix));
    return std::isfinite(turn) ? (static_cast<int>(std::lround(turn / 90)) + 4) % 4 : 0;
  }

  CameraOptions options_;
  bool file_, seen_ = false, finished_ = false;
  double owed_ = 0;  // pictures of the file that are due
  std::chrono::steady_clock::time_point give_up_;
  Owned<AVFormatContext> container_;
  Owned<AVCodecContext> decoder_;
  AVStream* stream_ = nullptr;  // of the container
  Owned<AVPacket> packet_{av_packet_alloc()};
  Owned<AVFrame> frame_{av_frame_alloc()}, bgr_;
  Owned<SwsContext> scaler_;
};

}  // namespace

// Missing at the start is an error; one that disappears later is waited for.
Expected<std::unique_ptr<Camera>> open_video(const CameraOptions& options) {
  auto camera = std::make_unique<Video>(options);
  if (auto opened = camera->open(); !opened) return tl::unexpected(opened.error());
  return camera;
}

}  // namespace prehend::recognition
