#include "services/cli/tools/doctor/leading.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "common/base/printable.hpp"

namespace prehend::cli {

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
  for (const auto& sample : frames_.take())
    if (!sample.info.gone) is_left_[sample.data.glove().to_string()] = sample.data.left();
  for (const auto& sample : feedback_.take())
    if (!sample.info.gone) glove_[sample.data.hand().to_string()] = sample.data.glove().to_string();
  for (const auto& sample : commands_.take())
    if (!sample.info.gone) model_[sample.data.hand().to_string()] = sample.data.model().to_string();
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
  if (led.empty()) return {"hands", true, "no glove leads a hand", ""};
  if (wrong.empty()) return {"hands", true, fmt::format("{}", fmt::join(led, ", ")), ""};
  return {"hands", false, fmt::format("{}", fmt::join(wrong, "; ")),
          "set glove.hand where the glove runs, or mapping.glove where it leads the wrong hand"};
}

}  // namespace prehend::cli
