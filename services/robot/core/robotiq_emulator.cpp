#include "services/robot/core/robotiq_emulator.hpp"

namespace prehend::robot::robotiq {
namespace {

constexpr Duration gap = std::chrono::milliseconds(20);  // a frame has no longer pause

}  // namespace

Expected<std::unique_ptr<robot::Emulator>> emulate_2f85(const model::HandModel& hand,
                                                        const EmulatedOptions& options) {
  if (auto fits = check_hand(hand, kind_2f85); !fits) return tl::unexpected(fits.error());
  return std::make_unique<Emulator>(hand, kind_2f85, options);
}

Expected<std::unique_ptr<robot::Emulator>> emulate_2f140(const model::HandModel& hand,
                                                         const EmulatedOptions& options) {
  if (auto fits = check_hand(hand, kind_2f140); !fits) return tl::unexpected(fits.error());
  return std::make_unique<Emulator>(hand, kind_2f140, options);
}

Emulator::Emulator(const model::HandModel& hand, const Kind& kind, const EmulatedOptions& options)
    : gripper_(hand, kind, options.initialized, options.velocity_scale),
      id_(options.id == 0 ? usual_id : static_cast<std::uint8_t>(options.id)),
      answers_as_(options.answers_as == 0 ? id_ : static_cast<std::uint8_t>(options.answers_as)) {}

std::string Emulator::pass(Duration now) {
  if (!parser_.is_empty() && now - heard_ > gap) parser_.clear();
  gripper_.pass(now);
  return {};
}

std::string Emulator::receive(std::string_view bytes, Duration now) {
  pass(now);
  heard_ = now;
  parser_.feed(bytes);
  std::string said;
  while (const auto question = parser_.next()) {
    auto answer = modbus::answer(*question, id_, gripper_.map);
    if (!answer) continue;
    gripper_.hear(now);
    gripper_.pass(now);  // what was written shows at once
    answer->id = answers_as_;
    said += modbus::encode(*answer);
  }
  return said;
}

}  // namespace prehend::robot::robotiq
