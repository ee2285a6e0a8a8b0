#include "services/mapping/tools/benchmark/own_by_messages.hpp"

#include "services/mapping/tools/benchmark/lab_messages.hpp"

namespace prehend::mapping {

Told at_date(Told told, Duration beginning) {
  if (told.detection) told.detection->stamp += beginning;
  if (told.state) told.state->stamp += beginning;
  if (told.posture) {
    told.posture->stamp += beginning;
    told.posture->origin += beginning;
  }
  return told;
}

Expected<std::vector<gate::Command>> OwnByMessages::answer(const Told& heard, Time now) {
  const Told told = at_date(heard, take_beginning);
  const Time date = now + take_beginning;
  std::vector<gate::Command> commands;
  const auto tick = [&] {
    if (const auto command = mapping_.tick(date)) take(*command, commands);
  };
  if (told.detection || told.state) {
    if (told.detection) (void)mapping_.on_detection(as_read(*told.detection));
    if (told.state) (void)mapping_.on_state(as_read(*told.state));
    tick();
  }
  if (told.posture) {
    if (const auto command = mapping_.on_posture(as_read(*told.posture), date))
      take(*command, commands);
    tick();
  }
  return commands;
}

void OwnByMessages::take(const Command& command, std::vector<gate::Command>& commands) {
  commands.push_back({{},
                      ++sequence_,
                      command.stamp - take_beginning,
                      benchmarked_hand_name,
                      hand_.name(),
                      {command.dof, as_read(command.X_WB)}});
}

}  // namespace prehend::mapping
