#include "services/glove/tools/frame_input.hpp"

#include <poll.h>
#include <unistd.h>

#include <mutex>
#include <optional>

#include "common/base/log.hpp"
#include "common/dds/participant.hpp"
#include "common/dds/raw.hpp"
#include "common/recording/mcap/reader.hpp"
#include "common/service/membership.hpp"
#include "services/glove/core/filter_report.hpp"
#include "services/glove/devices/device.hpp"
#include "services/glove/files/hand_recording.hpp"
#include "services/glove/service/messages.hpp"
#include "services/glove/service/options.hpp"

namespace prehend::glove {

struct FrameInput::State {
  std::optional<dds::Participant> participant;
  std::optional<dds::Reader<v1::GloveFrame>> reader;
  std::string glove;
  std::vector<Frame> recorded;
  std::mutex mutex;  // of what the device's thread has brought
  std::vector<Frame> driven;
  std::unique_ptr<Device> device;  // last: its thread ends before the rest goes
};

FrameInput::FrameInput(std::unique_ptr<State> state) : state_(std::move(state)) {}
FrameInput::FrameInput(FrameInput&&) noexcept = default;
FrameInput& FrameInput::operator=(FrameInput&&) noexcept = default;
FrameInput::~FrameInput() = default;

Expected<FrameInput> FrameInput::live(const service::Config& config) {
  auto participant = dds::Participant::create(service::membership(config, "glove-tool", "viewer"));
  if (!participant) return tl::unexpected(participant.error());
  auto state = std::make_unique<State>();
  state->participant.emplace(std::move(*participant));
  auto reader = state->participant->reader(dds::glove_frame);
  if (!reader) return tl::unexpected(reader.error());
  state->reader.emplace(std::move(*reader));
  state->glove = config.text("glove.name");
  return FrameInput(std::move(state));
}

Expected<FrameInput> FrameInput::driven(const service::Config& config) {
  const auto kind = find_device(config.text("glove.device"));
  if (!kind) return tl::unexpected(kind.error());
  const auto options = device_options(config);
  if (!options) return tl::unexpected(options.error());
  auto device = kind->create(*options);
  if (!device) return tl::unexpected(device.error());
  auto state = std::make_unique<State>();
  state->device = std::move(*device);
  State& shared = *state;
  shared.device->start({.frame =
                            [&shared](Frame frame) {
                              const std::scoped_lock lock(shared.mutex);
                              shared.driven.push_back(std::move(frame));
                            },
                        .degraded = [](const std::string& line) { log::warning("{}", line); },
                        .drop = [](std::string_view, std::uint64_t) {}});
  return FrameInput(std::move(state));
}

Expected<FrameInput> FrameInput::recorded(const std::filesystem::path& file) {
  auto state = std::make_unique<State>();
  if (file.extension() == ".mcap") {
    auto reader = recording::mcap::Reader::open(file);
    if (!reader) return tl::unexpected(reader.error());
    recording::mcap::MessageCursor cursor =
        reader->messages({.wanted = [](const recording::mcap::Channel& channel) {
          return channel.topic == dds::glove_frame.name;
        }});
    while (true) {
      const auto read = cursor.next();
      if (!read) continue;  // a damaged stretch: what can be read counts
      if (!*read) break;
      dds::RawSample sample;
      sample.payload.assign((*read)->message.data.begin(), (*read)->message.data.end());
      v1::GloveFrame message;
      if (dds::decode(dds::glove_frame, sample, message))
        state->recorded.push_back(from_message(message));
    }
  } else {
    const auto recording = Recording::load(file, {});
    if (!recording) return tl::unexpected(recording.error());
    if (const std::string told = recording->left_out(); !told.empty())
      log::warning("{}: left out: {}", file.string(), told);
    for (const std::string& remark : recording->remarks())
      log::warning("{}: {}", file.string(), remark);
    state->recorded = frames_of(*recording);
  }
  if (state->recorded.empty())
    return fail("holds nothing of a glove, on glove/frame", file.string(),
                "choose a recording that does: prehend recording info FILE says what it holds");
  return FrameInput(std::move(state));
}

std::vector<Frame> FrameInput::poll() {
  if (!live()) return std::exchange(state_->recorded, {});
  if (state_->device) {
    const std::scoped_lock lock(state_->mutex);
    return std::exchange(state_->driven, {});
  }
  std::vector<Frame> frames;
  for (const auto& sample : state_->reader->take())
    if (!sample.info.gone && sample.data.glove().to_string() == state_->glove)
      frames.push_back(from_message(sample.data));
  return frames;
}

bool FrameInput::live() const {
  return state_->reader.has_value() || state_->device;
}

char entered_key() {
  static bool closed = false;
  pollfd input{STDIN_FILENO, POLLIN, 0};
  char key = 0;
  if (closed || ::poll(&input, 1, 0) <= 0) return 0;
  if (::read(STDIN_FILENO, &key, 1) <= 0) closed = true;
  return key;
}

}  // namespace prehend::glove
