#include "services/recorder/tools/dataset/pictures.hpp"

#include <algorithm>

#include "common/recording/compare/recorded_topic.hpp"
#include "common/recording/mcap/reader.hpp"
#include "common/recording/messages/message_decoder.hpp"
#include "services/recorder/tools/dataset/ffmpeg.hpp"
#include "services/recorder/tools/dataset/message.hpp"
#include "services/recorder/tools/dataset/picture_file.hpp"

namespace prehend::recorder::dataset {

struct PictureDecoder::State {
  Ffmpeg<AVCodecContext> jpeg, png;
  Ffmpeg<AVPacket> packet{av_packet_alloc()};
  Ffmpeg<AVFrame> frame{av_frame_alloc()};
  Ffmpeg<SwsContext> scaler;

  static Ffmpeg<AVCodecContext> open(AVCodecID id) {
    const AVCodec* codec = avcodec_find_decoder(id);
    Ffmpeg<AVCodecContext> context(codec ? avcodec_alloc_context3(codec) : nullptr);
    if (!context) return nullptr;
    context->thread_count = 1;
    return avcodec_open2(context.get(), codec, nullptr) < 0 ? nullptr : std::move(context);
  }
};

PictureDecoder::PictureDecoder() : state_(std::make_unique<State>()) {
  av_log_set_level(AV_LOG_QUIET);  // what goes wrong is said by our errors
}
PictureDecoder::~PictureDecoder() = default;

Expected<Rgb> PictureDecoder::decode(const std::vector<std::uint8_t>& bytes, Size size) {
  State& state = *state_;
  const auto unreadable = [] { return fail("a picture cannot be decoded"); };
  const bool png = bytes.size() > 4 && bytes[1] == 'P' && bytes[2] == 'N' && bytes[3] == 'G';
  auto& decoder = png ? state.png : state.jpeg;
  if (!decoder) decoder = State::open(png ? AV_CODEC_ID_PNG : AV_CODEC_ID_MJPEG);
  if (!decoder || bytes.empty() || !state.packet || !state.frame) return unreadable();

  // The library reads a little past the end.
  std::vector<std::uint8_t> padded(bytes);
  padded.resize(bytes.size() + AV_INPUT_BUFFER_PADDING_SIZE);
  state.packet->data = padded.data();
  state.packet->size = static_cast<int>(bytes.size());
  state.packet->flags = AV_PKT_FLAG_KEY;  // or a png is added to the one before
  const bool decoded = avcodec_send_packet(decoder.get(), state.packet.get()) >= 0 &&
                       avcodec_receive_frame(decoder.get(), state.frame.get()) >= 0;
  state.packet->data = nullptr;
  state.packet->size = 0;
  if (!decoded) {
    decoder.reset();  // it may have kept a part
    return unreadable();
  }
  const AVFrame& frame = *state.frame;
  if (size.width == 0) size = {frame.width, frame.height};
  state.scaler.reset(sws_getCachedContext(
      state.scaler.release(), frame.width, frame.height, static_cast<AVPixelFormat>(frame.format),
      size.width, size.height, AV_PIX_FMT_RGB24, SWS_AREA, nullptr, nullptr, nullptr));
  Rgb picture{size, std::vector<std::uint8_t>(static_cast<std::size_t>(size.width) *
                                              static_cast<std::size_t>(size.height) * 3)};
  std::uint8_t* planes[] = {picture.bytes.data()};
  const int strides[] = {size.width * 3};
  if (!state.scaler || sws_scale(state.scaler.get(), frame.data, frame.linesize, 0, frame.height,
                                 planes, strides) != size.height)
    return unreadable();
  return picture;
}

Expected<void> read_pictures(
    const RecordedEpisode& episode, const std::string& camera,
    const std::function<Expected<void>(std::size_t, std::vector<std::uint8_t>)>& take) {
  const auto& times = episode.picture_times.at(camera);
  const auto& places = episode.rows.pictures.at(camera);
  auto reader = recording::mcap::Reader::open(episode.file);
  if (!reader) return tl::unexpected(reader.error());
  recording::MessageDecoder decoder(*reader);
  const auto mapped = episode.picture_sources.find(camera);
  const bool is_mapped = mapped != episode.picture_sources.end();
  const std::string wanted = is_mapped ? mapped->second.topic : "camera/image";
  const auto log_time = [&](std::size_t place) {
    return static_cast<std::uint64_t>(to_ns(times[place]));
  };
  auto cursor = reader->messages({log_time(places.front()), log_time(places.back()),
                                  [&](const recording::mcap::Channel& channel) {
                                    const auto topic =
                                        recording::recorded_topic(channel, reader->contents());
                                    return topic.end.empty() && topic.name == wanted;
                                  }});
  const FieldPath field = *FieldPath::parse("data");
  std::size_t done = 0;  // places that were taken, or are behind
  while (true) {
    const auto next = cursor.next();
    if (!next) continue;  // said when the recording was gone through
    if (!*next) break;
    const auto& [channel, message] = **next;
    const auto value = decoder.decode(*channel, message.data);
    if (!value || (!is_mapped && as_name(text(*value, "camera")) != camera)) continue;
    const auto time =
        std::ranges::lower_bound(times, from_ns(static_cast<std::int64_t>(message.log_time)));
    const auto place = static_cast<std::size_t>(time - times.begin());
    if (place < done || !std::ranges::binary_search(places, place)) continue;
    done = place + 1;
    const auto bytes = picture_file(*value, is_mapped ? mapped->second.field : field);
    if (auto taken = take(place, bytes.value_or(std::vector<std::uint8_t>{})); !taken) return taken;
  }
  return {};
}

Expected<void> read_rows(const RecordedEpisode& episode, const std::string& camera, Size size,
                         const std::function<Expected<void>(const Rgb&)>& take) {
  const auto& places = episode.rows.pictures.at(camera);
  PictureDecoder decoder;
  std::optional<Rgb> now;
  std::size_t row = 0;
  // Rows before the picture show the one before it.
  const auto write_until = [&](std::size_t place) -> Expected<void> {
    for (; row < places.size() && places[row] < place; ++row) {
      if (!now) return fail("no picture of " + camera + " can be decoded", episode.file.string());
      if (auto taken = take(*now); !taken) return taken;
    }
    return {};
  };
  auto read = read_pictures(
      episode, camera, [&](std::size_t place, std::vector<std::uint8_t> bytes) -> Expected<void> {
        auto decoded = decoder.decode(bytes, size);
        // The first one has nobody before it.
        if (!now && decoded) now = *decoded;
        if (auto written = write_until(place); !written) return written;
        if (decoded) now = std::move(*decoded);
        return {};
      });
  if (!read) return read;
  return write_until(places.back() + 1);
}

}  // namespace prehend::recorder::dataset
