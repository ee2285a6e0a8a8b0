#include "services/recorder/tools/dataset/picture_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "common/base/printable.hpp"
#include "services/recorder/tools/dataset/ffmpeg.hpp"
#include "services/recorder/tools/dataset/message.hpp"

namespace prehend::recorder::dataset {
namespace {

constexpr double max_pixels = 16384;  // along a side

/// One that ROS names: its bytes a pixel, and whether pixels come in pairs or in squares.
struct Encoding {
  const char* name;
  int bytes;
  bool even;
  AVPixelFormat little, big;
};
constexpr std::array<Encoding, 16> encodings{{
    {"rgb8", 3, false, AV_PIX_FMT_RGB24, AV_PIX_FMT_RGB24},
    {"bgr8", 3, false, AV_PIX_FMT_BGR24, AV_PIX_FMT_BGR24},
    {"8UC3", 3, false, AV_PIX_FMT_BGR24, AV_PIX_FMT_BGR24},
    {"rgba8", 4, false, AV_PIX_FMT_RGBA, AV_PIX_FMT_RGBA},
    {"bgra8", 4, false, AV_PIX_FMT_BGRA, AV_PIX_FMT_BGRA},
    {"mono8", 1, false, AV_PIX_FMT_GRAY8, AV_PIX_FMT_GRAY8},
    {"8UC1", 1, false, AV_PIX_FMT_GRAY8, AV_PIX_FMT_GRAY8},
    {"mono16", 2, false, AV_PIX_FMT_GRAY16LE, AV_PIX_FMT_GRAY16BE},
    {"bayer_rggb8", 1, true, AV_PIX_FMT_BAYER_RGGB8, AV_PIX_FMT_BAYER_RGGB8},
    {"bayer_bggr8", 1, true, AV_PIX_FMT_BAYER_BGGR8, AV_PIX_FMT_BAYER_BGGR8},
    {"bayer_gbrg8", 1, true, AV_PIX_FMT_BAYER_GBRG8, AV_PIX_FMT_BAYER_GBRG8},
    {"bayer_grbg8", 1, true, AV_PIX_FMT_BAYER_GRBG8, AV_PIX_FMT_BAYER_GRBG8},
    {"yuv422", 2, true, AV_PIX_FMT_UYVY422, AV_PIX_FMT_UYVY422},
    {"uyvy", 2, true, AV_PIX_FMT_UYVY422, AV_PIX_FMT_UYVY422},
    {"yuv422_yuy2", 2, true, AV_PIX_FMT_YUYV422, AV_PIX_FMT_YUYV422},
    {"yuyv", 2, true, AV_PIX_FMT_YUYV422, AV_PIX_FMT_YUYV422},
}};

struct Raw {
  AVPixelFormat format;
  int width, height, step;  // px, px, bytes from row to row
};

/// What stands beside the bytes, checked against how many there are.
Expected<Raw> raw_beside(const Value& holder, std::size_t bytes) {
  const std::string name = text(holder, "encoding");
  const auto known = std::ranges::find(encodings, name, &Encoding::name);
  if (known == encodings.end())
    return fail(fmt::format("has the encoding «{}», which is no picture", printable(name)));
  const auto width = number(holder, "width"), height = number(holder, "height");
  const auto step = number(holder, "step");
  const auto is_side = [&](const std::optional<double>& side) {
    return side && *side >= (known->even ? 2 : 1) && *side <= max_pixels &&
           (!known->even || static_cast<int>(*side) % 2 == 0);
  };
  if (!is_side(width) || !is_side(height) || !step || *step < *width * known->bytes ||
      *step > 16 * max_pixels || *step * *height > static_cast<double>(bytes))
    return fail("has not the bytes that its width, height and step tell");
  const bool big = flag(holder, "is_bigendian") || number(holder, "is_bigendian").value_or(0) != 0;
  return Raw{big ? known->big : known->little, static_cast<int>(*width), static_cast<int>(*height),
             static_cast<int>(*step)};
}

/// Nothing where the library has no memory.
Ffmpeg<AVFrame> in_colours(const Raw& raw, const std::vector<std::uint8_t>& bytes) {
  Ffmpeg<AVFrame> frame(av_frame_alloc());
  if (!frame) return nullptr;
  frame->format = AV_PIX_FMT_RGB24;
  frame->width = raw.width;
  frame->height = raw.height;
  const Ffmpeg<SwsContext> scaler(
      sws_getContext(raw.width, raw.height, raw.format, raw.width, raw.height, AV_PIX_FMT_RGB24,
                     SWS_POINT | SWS_ACCURATE_RND, nullptr, nullptr, nullptr));
  const std::uint8_t* planes[] = {bytes.data(), nullptr, nullptr, nullptr};
  const int steps[] = {raw.step, 0, 0, 0};
  if (!scaler || av_frame_get_buffer(frame.get(), 0) < 0 ||
      sws_scale(scaler.get(), planes, steps, 0, raw.height, frame->data, frame->linesize) !=
          raw.height)
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
  const auto raw = raw_beside(*holder, bytes->size());
  if (!raw) return tl::unexpected(raw.error());
  bytes->resize(bytes->size() + AV_INPUT_BUFFER_PADDING_SIZE);  // the library reads past the end
  const auto frame = in_colours(*raw, *bytes);
  auto png = frame ? as_png(*frame) : std::nullopt;
  if (!png) return fail("cannot be made a png");
  return std::move(*png);
}

}  // namespace prehend::recorder::dataset
