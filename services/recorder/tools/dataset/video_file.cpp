#include "services/recorder/tools/dataset/video_file.hpp"

#include "services/recorder/tools/dataset/ffmpeg.hpp"

namespace prehend::recorder::dataset {

struct VideoFile::State {
  std::string name;
  AVFormatContext* container = nullptr;
  AVStream* stream = nullptr;  // of the container
  Ffmpeg<AVCodecContext> encoder;
  Ffmpeg<SwsContext> scaler;
  Ffmpeg<AVPacket> packet{av_packet_alloc()};
  Ffmpeg<AVFrame> frame{av_frame_alloc()};
  std::size_t frames = 0;

  ~State() {
    if (!container) return;
    if (container->pb) avio_closep(&container->pb);
    avformat_free_context(container);
  }
  tl::unexpected<Error> failure(const char* what, int code) const {
    char words[AV_ERROR_MAX_STRING_SIZE] = {};
    av_strerror(code, words, sizeof words);
    return fail(std::string(what) + ": " + words, name);
  }
  Expected<void> begin(Size size, int rate);
  Expected<void> write_packets();
};

Expected<void> VideoFile::State::begin(Size size, int rate) {
  const AVCodec* codec = avcodec_find_encoder_by_name("libx264");
  if (!codec) return fail("this libavcodec cannot encode H.264", name, "Debian's can");
  int done = avformat_alloc_output_context2(&container, nullptr, "mp4", name.c_str());
  if (done < 0) return failure("cannot be begun", done);
  stream = avformat_new_stream(container, nullptr);
  encoder.reset(avcodec_alloc_context3(codec));
  if (!stream || !encoder || !packet || !frame) return failure("cannot be begun", AVERROR(ENOMEM));
  encoder->width = size.width;
  encoder->height = size.height;
  encoder->pix_fmt = AV_PIX_FMT_YUV420P;
  encoder->color_range = AVCOL_RANGE_MPEG;
  encoder->colorspace = AVCOL_SPC_SMPTE170M;
  encoder->time_base = {1, rate};
  encoder->framerate = {rate, 1};
  encoder->gop_size = 2;
  encoder->max_b_frames = 0;
  encoder->thread_count = 1;  // the same bytes on every machine
  if (container->oformat->flags & AVFMT_GLOBALHEADER) encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  av_opt_set(encoder->priv_data, "preset", "veryfast", 0);
  av_opt_set(encoder->priv_data, "crf", "20", 0);
  if (done = avcodec_open2(encoder.get(), codec, nullptr); done < 0)
    return failure("H.264 cannot be encoded", done);
  stream->time_base = encoder->time_base;
  stream->avg_frame_rate = encoder->framerate;
  avcodec_parameters_from_context(stream->codecpar, encoder.get());
  if (done = avio_open(&container->pb, name.c_str(), AVIO_FLAG_WRITE); done < 0)
    return failure("cannot be written", done);
  if (done = avformat_write_header(container, nullptr); done < 0)
    return failure("cannot be written", done);
  frame->format = encoder->pix_fmt;
  frame->width = size.width;
  frame->height = size.height;
  if (done = av_frame_get_buffer(frame.get(), 0); done < 0) return failure("cannot be begun", done);
  scaler.reset(sws_getContext(size.width, size.height, AV_PIX_FMT_RGB24, size.width, size.height,
                              encoder->pix_fmt, SWS_BILINEAR, nullptr, nullptr, nullptr));
  if (!scaler) return failure("cannot be begun", AVERROR(ENOMEM));
  return {};
}

Expected<void> VideoFile::State::write_packets() {
  while (true) {
    int done = avcodec_receive_packet(encoder.get(), packet.get());
    if (done == AVERROR(EAGAIN) || done == AVERROR_EOF) return {};
    if (done < 0) return failure("a picture cannot be encoded", done);
    av_packet_rescale_ts(packet.get(), encoder->time_base, stream->time_base);
    packet->duration = av_rescale_q(1, encoder->time_base, stream->time_base);
    packet->stream_index = stream->index;
    done = av_interleaved_write_frame(container, packet.get());
    if (done < 0) return failure("cannot be written", done);
  }
}

Expected<VideoFile> VideoFile::create(const std::filesystem::path& path, Size size, int rate) {
  av_log_set_level(AV_LOG_QUIET);
  auto state = std::make_unique<State>();
  state->name = path.string();
  if (auto begun = state->begin(size, rate); !begun) return tl::unexpected(begun.error());
  return VideoFile(std::move(state));
}

VideoFile::VideoFile(std::unique_ptr<State> state) : state_(std::move(state)) {}
VideoFile::VideoFile(VideoFile&&) noexcept = default;
VideoFile& VideoFile::operator=(VideoFile&&) noexcept = default;
VideoFile::~VideoFile() = default;

Expected<void> VideoFile::add(const Rgb& picture) {
  State& state = *state_;
  // The encoder may still hold the last one.
  if (const int done = av_frame_make_writable(state.frame.get()); done < 0)
    return state.failure("a picture cannot be encoded", done);
  const std::uint8_t* planes[] = {picture.bytes.data()};
  const int strides[] = {picture.size.width * 3};
  sws_scale(state.scaler.get(), planes, strides, 0, picture.size.height, state.frame->data,
            state.frame->linesize);
  state.frame->pts = static_cast<std::int64_t>(state.frames++);
  if (const int done = avcodec_send_frame(state.encoder.get(), state.frame.get()); done < 0)
    return state.failure("a picture cannot be encoded", done);
  return state.write_packets();
}

Expected<void> VideoFile::close() {
  State& state = *state_;
  avcodec_send_frame(state.encoder.get(), nullptr);
  if (auto written = state.write_packets(); !written) return written;
  int done = av_write_trailer(state.container);
  if (const int closed = avio_closep(&state.container->pb); done >= 0) done = closed;
  if (done < 0) return state.failure("cannot be written", done);
  return {};
}

std::size_t VideoFile::frames() const {
  return state_->frames;
}

}  // namespace prehend::recorder::dataset
