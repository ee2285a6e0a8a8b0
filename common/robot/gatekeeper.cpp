#include "common/robot/gatekeeper.hpp"

#include <limits>
#include <utility>

#include "common/base/log.hpp"
#include "common/convert/convert.hpp"
#include "common/dds/topics.hpp"

namespace prehend::robot {
namespace {

constexpr Duration patience = std::chrono::milliseconds(300);  // with silent commands
constexpr Duration start_up = std::chrono::seconds(3);         // until some come
constexpr Duration noticed = std::chrono::seconds(1);          // a second writer is, for so long

constexpr const char* unled = "nobody sends robot/command; the hand stays as it is";

gate::Command from_message(const v1::HandCommand& message, const dds::SampleInfo& info) {
  Pose nowhere;
  nowhere.matrix().setConstant(std::numeric_limits<double>::quiet_NaN());
  gate::Command command;
  command.writer = info.participant;
  command.sequence = message.sequence_number();
  command.stamp = from_ns(message.stamp_ns());
  command.hand = message.hand().to_string();
  command.model = message.model().to_string();
  command.place = {convert::from_message(message.dof()),
                   convert::from_message(message.X_WB()).value_or(nowhere)};
  return command;
}

gate::Limits limits_of(const model::HandModel& hand, const service::Config& config) {
  gate::Limits limits = gate::limits_of(hand);
  limits.base = {config.number("gate.base_speed"), config.number("gate.base_acceleration")};
  limits.turn = {config.number("gate.base_turn_speed"),
                 config.number("gate.base_turn_acceleration")};
  const auto& box = config.numbers("gate.box");
  if (box.size() == 6) {
    limits.box_lower = {box[0], box[1], box[2]};
    limits.box_upper = {box[3], box[4], box[5]};
  } else {
    limits.box_upper = limits.box_lower;  // is refused as empty
  }
  return limits;
}

}  // namespace

Expected<std::unique_ptr<Gatekeeper>> Gatekeeper::create(service::Shell& shell,
                                                         const model::HandModel& hand,
                                                         const std::string& name, Robot robot) {
  const service::Config& config = shell.config();
  auto gate = gate::CommandGate::create(hand,
                                        {.hand = name,
                                         .max_age = seconds(config.number("gate.max_age")),
                                         .max_silence = seconds(config.number("gate.max_silence"))},
                                        limits_of(hand, config), robot.where);
  if (!gate) {
    gate.error().exit = exit_wrong_use;
    return tl::unexpected(gate.error());
  }
  return std::unique_ptr<Gatekeeper>(new Gatekeeper(shell, std::move(*gate), std::move(robot)));
}

Gatekeeper::Gatekeeper(service::Shell& shell, gate::CommandGate gate, Robot robot)
    : shell_(shell),
      robot_(std::move(robot)),
      gate_(std::move(gate)),
      last_obeyed_(shell.now() + start_up) {
  shell_.subscribe(dds::robot_command, std::function([this](const v1::HandCommand& message,
                                                            const dds::SampleInfo& info) {
                     // Whoever commanded is gone: the hand holds still once its command is stale.
                     if (!info.gone) on_command(message, info);
                   }));
}

void Gatekeeper::on_command(const v1::HandCommand& message, const dds::SampleInfo& info) {
  const Time now = shell_.now();
  const auto passed = gate_.admit(from_message(message, info), now);
  if (!passed) return refuse(passed.error(), info, now);
  if (gate_.leads() != leads_) {
    leads_ = gate_.leads();
    leader_ = shell_.writer_of(info);
    shell_.status().count("leads");
    log::info("{} leads the hand", leader_);
  }
  obey(message, info, *passed, now);
}

void Gatekeeper::refuse(gate::Refusal refusal, const dds::SampleInfo& info, Time now) {
  shell_.status().drop(to_string(refusal));
  if (refusal == gate::Refusal::another_hand) return;  // it is not for us
  Refused refused{std::string(to_string(refusal)), shell_.writer_of(info), now};
  if (refusal == gate::Refusal::second_writer)
    second_ = std::move(refused);
  else
    refused_ = std::move(refused);
}

void Gatekeeper::obey(const v1::HandCommand& message, const dds::SampleInfo& info,
                      const gate::Passed& passed, Time now) {
  for (std::size_t i = 0; i < gate::cuts; ++i)
    if (passed.cut[i]) shell_.status().drop(to_string(static_cast<gate::Cut>(i)));
  if (auto obeyed = robot_.obey(message, passed.place, now); !obeyed) {
    shell_.status().drop(obeyed.error().what);
    refused_ = Refused{obeyed.error().what, shell_.writer_of(info), now};
    return;
  }
  last_obeyed_ = now;
  shell_.status().count("commands");
  if (message.origin_ns() != 0)  // a hand that is told to hold still answers no glove frame
    shell_.status().latency("glove to accepted", now - from_ns(message.origin_ns()));
  shell_.status().latency("command hop", now - info.sent);
}

/// That the hand holds still then is the robot's own doing.
std::string Gatekeeper::missing(Time now) const {
  const bool silent = now - last_obeyed_ > patience;
  // At the start commands are waited for, unless some come that cannot be obeyed.
  const bool refused = refused_ && now - refused_->at <= patience && (silent || last_obeyed_ > now);
  if (refused)
    return "robot/command is refused: " + refused_->why + ", of " + refused_->writer +
           "; the hand stays as it is";
  if (silent) return unled;
  if (second_ && now - second_->at <= noticed)
    return "robot/command of " + second_->writer + " is refused, for " + leader_ + " leads";
  return {};
}

void Gatekeeper::look_around(Time now) {
  std::string found = missing(now);
  if (found == missing_) return;
  missing_ = std::move(found);
  if (missing_.empty()) return shell_.status().running();
  log::warning("{}", missing_);
  shell_.status().degraded(missing_);
}

}  // namespace prehend::robot
