#include "plans.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <prehend/base/workers.hpp>
#include <stdexcept>

namespace prehend::simulation {
namespace {

const std::filesystem::path hands = std::string(PREHEND_SOURCE) + "/common/models/hands";

}  // namespace

std::vector<std::string> all_hands() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(hands))
    if (std::filesystem::exists(entry.path() / "hand.toml"))
      names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

const model::HandModel& hand_called(const std::string& name) {
  static std::map<std::string, model::HandModel> loaded;
  if (const auto found = loaded.find(name); found != loaded.end()) return found->second;
  auto hand = model::HandModel::load(hands / name);
  if (!hand) throw std::runtime_error(hand.error().message());
  return loaded.emplace(name, std::move(*hand)).first->second;
}

grasping::Plan plan(const std::string& hand, const grasping::Body& object,
                    const grasping::PlanOptions& options, unsigned threads) {
  auto planned = grasping::plan_grasps(hand_called(hand), object, options,
                                       [&](std::size_t count, const auto& work) {
                                         share_work(count, threads, work, [](std::size_t) {});
                                       });
  if (!planned) throw std::runtime_error(planned.error().message());
  return std::move(*planned);
}

const grasping::Plan& barrett_on_talc() {
  static const grasping::Plan planned =
      plan("barrett", talc, {.candidates = 16, .seed = 3, .tested = 3, .most_tested = 6});
  return planned;
}

}  // namespace prehend::simulation
