#include "services/recorder/service/operator_link.hpp"

namespace prehend::recorder {

OperatorLink::OperatorLink(service::Shell& shell, std::string name, Obey execute,
                           std::optional<dds::GuidPrefix> player)
    : shell_(shell),
      name_(std::move(name)),
      obey_(std::move(execute)),
      player_(player),
      replies_(shell.publish(dds::operator_reply)) {
  shell.subscribe(dds::operator_command,
                  [this](const v1::OperatorCommand& command, const dds::SampleInfo& info) {
                    if (!info.gone && info.participant != player_) on_command(command);
                  });
}

void OperatorLink::on_command(const v1::OperatorCommand& command) {
  const std::string target = command.target().to_string();
  if (!target.empty() && target != name_) return;
  if (command.action() != v1::ACTION_START && command.action() != v1::ACTION_STOP) return;
  std::string order = command.argument().to_string();
  if (order.empty()) order = command.action() == v1::ACTION_START ? "start" : "stop";
  const auto answer = obey_(order);
  v1::OperatorReply reply;
  reply.id(command.id());
  reply.stamp_ns(to_ns(shell_.now()));
  reply.service(name_);
  reply.done(answer.has_value());
  reply.message((answer ? *answer : answer.error().message()).substr(0, 255));
  replies_.publish(reply);
}

}  // namespace prehend::recorder
