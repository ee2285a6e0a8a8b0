#include "services/cli/tools/doctor/leading.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "common/base/printable.hpp"

namespace prehend::cli {
namespace {

constexpr std::size_t kept_frames = 1000;  // frames, of which a command may come

}  // namespace

Leading::Leading(dds::Reader<v1::GloveFrame> frames, dds::Reader<v1::GloveFeedback> feedback,
                 dds::Reader<v2::HandCommand> commands)
    : frames_(std::move(frames)), feedback_(std::move(feedback)), commands_(std::move(commands)) {}

Expected<Leading> Leading::create(dds::Participant& participant) {
  auto frames = participant.reader(dds::glove_frame);
  if (!frames) return tl::unexpected(frames.error());
  auto feedback = participant.reader(dds::glove_feedback);
  if (!feedback) return tl::unexpected(feedback.error());
  auto commands = participant.reader(dds::robot_command);
  if (!commands) return tl::unexpected(commands.error());
  return Leading(std::move(*frames), std::move(*feedback), std::move(*commands));
}

void Leading::hear() {
  for (const auto& sample : frames_.take()) {
    if (sample.info.gone) continue;
    is_left_[sample.data.glove().to_string()] = sample.data.left();
    frame_of_[sample.data.stamp_ns()] = sample.data.glove().to_string();
  }
  while (frame_of_.size() > kept_frames) frame_of_.erase(frame_of_.begin());
  for (const auto& sample : feedback_.take())
    if (!sample.info.gone) glove_[sample.data.hand().to_string()] = sample.data.glove().to_string();
  for (const auto& sample : commands_.take()) {
    if (sample.info.gone) continue;
    const std::string hand = sample.data.hand().to_string();
    model_[hand] = sample.data.model().to_string();
    const auto led_by = frame_of_.find(sample.data.origin_ns());
    if (led_by != frame_of_.end()) glove_[hand] = led_by->second;
  }
}

Check Leading::judge() const {
  std::vector<std::string> led, wrong;
  std::map<std::string, std::string> leads;  // a hand, by glove
  for (const auto& [hand, glove] : glove_) {
    led.push_back(printable(fmt::format("{} leads {}", glove, hand)));
    const auto [other, alone] = leads.try_emplace(glove, hand);
    if (!alone)
      wrong.push_back(printable(fmt::format("{} leads {} and {}", glove, other->second, hand)));
    const auto model = model_.find(hand);
    const auto worn = is_left_.find(glove);
    if (glove_.size() < 2 || model == model_.end() || worn == is_left_.end()) continue;
    if (model->second.ends_with("_left") != worn->second)
      wrong.push_back(printable(fmt::format("{} is on a {} hand and leads {}, a {}", glove,
                                            worn->second ? "left" : "right", hand, model->second)));
  }
  if (led.empty()) return {"hands", true, "nothing tells that a glove leads a hand", ""};
  if (wrong.empty()) return {"hands", true, fmt::format("{}", fmt::join(led, ", ")), ""};
  return {"hands", false, fmt::format("{}", fmt::join(wrong, "; ")),
          "set glove.hand where the glove runs, or mapping.glove where it leads the wrong hand"};
}

}  // namespace prehend::cli
