#include "services/recorder/tools/dataset/picture_file.hpp"

#include "common/ros2/pixels.hpp"
#include "services/recorder/tools/dataset/ffmpeg.hpp"
#include "services/recorder/tools/dataset/message.hpp"

namespace prehend::recorder::dataset {
namespace {

AVPixelFormat format_of(ros2::Pixels pixels) {
  using enum ros2::Pixels;
  switch (pixels) {
    case rgb:
      return AV_PIX_FMT_RGB24;
    case bgr:
      return AV_PIX_FMT_BGR24;
    case rgba:
      return AV_PIX_FMT_RGBA;
    case bgra:
      return AV_PIX_FMT_BGRA;
    case grey:
      return AV_PIX_FMT_GRAY8;
    case grey_low_first:
      return AV_PIX_FMT_GRAY16LE;
    case grey_high_first:
      return AV_PIX_FMT_GRAY16BE;
    case mosaic_rggb:
      return AV_PIX_FMT_BAYER_RGGB8;
    case mosaic_bggr:
      return AV_PIX_FMT_BAYER_BGGR8;
    case mosaic_gbrg:
      return AV_PIX_FMT_BAYER_GBRG8;
    case mosaic_grbg:
      return AV_PIX_FMT_BAYER_GRBG8;
    case uyvy:
      return AV_PIX_FMT_UYVY422;
    case yuyv:
      return AV_PIX_FMT_YUYV422;
  }
  return AV_PIX_FMT_NONE;
}

/// The picture whose bytes are a field of the holder; 0 where a number is missing or none.
ros2::RawPicture raw_of(const Value& holder, std::vector<std::uint8_t> bytes) {
  const auto count = [&](const char* field) {
    const double told = number(holder, field).value_or(0);
    return told >= 0 && told <= 0xffffffff ? static_cast<std::uint32_t>(told) : 0;
  };
  ros2::RawPicture made;
  made.encoding = text(holder, "encoding");
  made.width = count("width");
  made.height = count("height");
  made.step = count("step");
  made.big_endian = flag(holder, "is_bigendian") || count("is_bigendian") != 0;
  made.data = std::move(bytes);
  return made;
}

/// Nothing where the library has no memory.
Ffmpeg<AVFrame> in_colours(ros2::RawPicture raw, AVPixelFormat format) {
  const int width = static_cast<int>(raw.width), height = static_cast<int>(raw.height);
  raw.data.resize(raw.data.size() + AV_INPUT_BUFFER_PADDING_SIZE);  // it reads past the end
  Ffmpeg<AVFrame> frame(av_frame_alloc());
  if (!frame) return nullptr;
  frame->format = AV_PIX_FMT_RGB24;
  frame->width = width;
  frame->height = height;
  const Ffmpeg<SwsContext> scaler(sws_getContext(width, height, format, width, height,
                                                 AV_PIX_FMT_RGB24, SWS_POINT | SWS_ACCURATE_RND,
                                                 nullptr, nullptr, nullptr));
  const std::uint8_t* planes[] = {raw.data.data(), nullptr, nullptr, nullptr};
  const int steps[] = {static_cast<int>(raw.step), 0, 0, 0};
  if (!scaler || av_frame_get_buffer(frame.get(), 0) < 0 ||
      sws_scale(scaler.get(), planes, steps, 0, height, frame->data, frame->linesize) != height)
    return nullptr;
  return frame;
}

std::optional<std::vector<std::uint8_t>> as_png(const AVFrame& frame) {
  const AVCodec* codec = avcodec_find_encoder(AV_CODEC_ID_PNG);
  const Ffmpeg<AVCodecContext> encoder(codec ? avcodec_alloc_context3(codec) : nullptr);
  const Ffmpeg<AVPacket> packet(av_packet_alloc());
  if (!encoder || !packet) return std::nullopt;
  encoder->width = frame.width;
  encoder->height = frame.height;
  encoder->pix_fmt = AV_PIX_FMT_RGB24;
  encoder->time_base = {1, 1};
  encoder->thread_count = 1;
  encoder->compression_level = 1;
  if (avcodec_open2(encoder.get(), codec, nullptr) < 0 ||
      avcodec_send_frame(encoder.get(), &frame) < 0 ||
      avcodec_receive_packet(encoder.get(), packet.get()) < 0)
    return std::nullopt;
  return std::vector<std::uint8_t>(packet->data, packet->data + packet->size);
}

}  // namespace

Expected<std::vector<std::uint8_t>> picture_file(const Value& message, const FieldPath& field) {
  const Value* value = field.in(message);
  auto bytes = value ? bytes_of(*value) : std::nullopt;
  if (!bytes || bytes->empty()) return fail("is no picture");
  const Value* holder = field.holder_in(message);
  if (!holder || !holder->find("step")) return std::move(*bytes);
  ros2::RawPicture raw = raw_of(*holder, std::move(*bytes));
  const auto pixels = ros2::pixels_of(raw);
  if (!pixels) return tl::unexpected(pixels.error());
  const auto frame = in_colours(std::move(raw), format_of(*pixels));
  auto png = frame ? as_png(*frame) : std::nullopt;
  if (!png) return fail("cannot be made a png");
  return std::move(*png);
}

}  // namespace prehend::recorder::dataset
