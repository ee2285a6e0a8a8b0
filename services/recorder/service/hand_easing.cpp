#include "services/recorder/service/hand_easing.hpp"

#include "common/convert/convert.hpp"

namespace prehend::recorder {

Expected<HandEasing> HandEasing::create(Tape& tape, const std::string& hand) {
  while (auto played = tape.next()) {
    if (played->stream->topic.name != dds::robot_command.name ||
        played->sample.kind != dds::RawSample::Kind::data)
      continue;
    v2::HandCommand command;
    if (!dds::decode(dds::robot_command, played->sample, command) ||
        command.hand().to_string() != hand)
      continue;
    const auto folder = model::named_hand(command.model().to_string());
    if (!folder) return tl::unexpected(folder.error());
    auto model = model::HandModel::load(*folder);
    if (!model) return tl::unexpected(model.error());
    const auto X_WB = convert::from_message(command.X_WB());
    if (!X_WB) return tl::unexpected(X_WB.error());
    const HandPlace to{convert::from_message(command.dof()), *X_WB};
    if (to.dof.size() != static_cast<Eigen::Index>(model->dofs().size()))
      return fail("the first command does not fit the hand", "--ease-in " + hand);
    return HandEasing(std::move(*played), command, std::move(*model), to);
  }
  return fail("the recording holds no robot/command for it", "--ease-in " + hand);
}

HandEasing::HandEasing(Played first, const v2::HandCommand& command, model::HandModel model,
                       HandPlace to)
    : first_(std::move(first)), command_(command), model_(std::move(model)), to_(std::move(to)) {
  // It moves the hand, and knows nothing of objects: whoever watches for a hand that stands still
  // must not take it for one.
  command_.mode(v1::MODE_DIRECT);
  command_.weight(0);
  command_.object("");
  command_.grasp_type(v1::GRASP_NONE);
  command_.extrapolating(false);
  command_.origin_ns(0);
}

void HandEasing::on_state(const v1::HandState& state, Time now) {
  const auto X_WB = convert::from_message(state.X_WB());
  const HandPlace from{convert::from_message(state.dof()), X_WB ? *X_WB : Pose::Identity()};
  if (way_ || !X_WB || from.dof.size() != to_.dof.size() || !from.dof.allFinite()) return;
  way_.emplace(model_, from, to_);
  began_ = now;
}

dds::RawSample HandEasing::command(Time now) {
  const HandPlace place = way_->at(now - began_);
  command_.stamp_ns(to_ns(now));
  command_.dof(convert::to_message(place.dof));
  command_.X_WB(convert::to_message(place.X_WB));
  dds::RawSample sample = first_.sample;
  sample.payload = dds::encode(dds::robot_command, command_);
  sample.sent = now;
  return sample;
}

}  // namespace prehend::recorder
