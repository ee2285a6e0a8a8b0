#include "services/cli/tools/demo/chosen_hand.hpp"

#include <algorithm>
#include <filesystem>

#include "common/base/paths.hpp"
#include "common/model/hand_model.hpp"
#include "common/stage/first_training.hpp"

namespace prehend::cli {
namespace {

/// All that come with us do, but for the human one.
bool comes_trained(const std::string& hand) {
  std::error_code none;
  return is_ours(hand) &&
         std::filesystem::exists(share_directory() / "trained" / (hand + ".mapping"), none);
}

}  // namespace

bool is_ours(const std::string& hand) {
  const auto names = model::hand_names();
  return hand.empty() || std::find(names.begin(), names.end(), hand) != names.end();
}

bool is_planned_for(const std::string& hand, const std::string& mode) {
  return mode == "planned" || (mode.empty() && !is_ours(hand));
}

std::string hand_of_robot(const std::string& robot) {
  const std::string device = robot.substr(robot.find(':') + 1);
  return is_ours(device) ? device : std::string();
}

std::string hand_setting(const std::string& hand) {
  if (is_ours(hand)) return hand;
  return std::filesystem::absolute(model::hand_directory(hand)).string();
}

Expected<void> train_hand(const DemoOptions& options) {
  const auto& without = options.without;
  if (options.attach || std::find(without.begin(), without.end(), "mapping") != without.end())
    return {};
  std::string hand = hand_setting(options.hand);
  if (hand.empty()) {
    const auto config = options.lab.load();
    if (!config) return wrong_use(config.error().what, config.error().where, config.error().hint);
    if (!config->path("mapping.model").empty()) return {};
    hand = config->text("mapping.hand");
  }
  std::error_code none;
  const bool is_there =
      std::filesystem::exists(model::hand_directory(hand) / "hand.urdf", none);  // else it is told
  return hand.empty() || comes_trained(hand) || !is_there ? Expected<void>()
                                                          : stage::train_if_needed(hand);
}

}  // namespace prehend::cli
