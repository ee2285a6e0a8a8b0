#include "tests/integration/recorder_rig.hpp"

namespace prehend::integration {

stage::Process RecorderRig::record(const std::string& name, Strings more) {
  Strings arguments = lab_arguments();
  arguments.insert(arguments.end(), {"--output", file(name), "--quiet"});
  arguments.insert(arguments.end(), more.begin(), more.end());
  auto process = start_program("prehend-record", arguments);
  wait_for("recorder");
  return process;
}

stage::Process RecorderRig::replay(const std::string& name, Strings more) {
  Strings arguments = lab_arguments();
  arguments.insert(arguments.end(), {file(name), "--quiet"});
  arguments.insert(arguments.end(), more.begin(), more.end());
  return start_program("prehend-replay", arguments);
}

void RecorderRig::wait_for(const std::string& service) {
  if (!statuses_) statuses_.emplace(reader(dds::service_status));
  ASSERT_TRUE(hear<v1::ServiceStatus>(*statuses_, 20, [&](const v1::ServiceStatus& status) {
    return status.name().to_string() == service;
  }));
}

int RecorderRig::end(stage::Process& process, int signal) {
  process.signal(signal);
  const auto exit = process.wait(seconds(20));
  return exit ? exit->code : -1;
}

v1::OperatorReply RecorderRig::order(const std::string& target, const std::string& argument) {
  if (!orders_) {
    orders_.emplace(writer(dds::operator_command));
    replies_.emplace(reader(dds::operator_reply));
  }
  v1::OperatorCommand command;
  const std::string id = "order-" + std::to_string(++order_count_);
  command.id(id);
  command.stamp_ns(now_ns());
  command.action(v1::ACTION_START);
  command.target(target);
  command.argument(argument);
  std::optional<v1::OperatorReply> reply;
  // Again until the program has found us: obeying twice does not matter to these orders.
  eventually(15, [&] {
    orders_->write(command);
    reply = hear<v1::OperatorReply>(
        *replies_, 0.5, [&](const v1::OperatorReply& one) { return one.id().to_string() == id; });
    return reply.has_value();
  });
  EXPECT_TRUE(reply) << argument;
  return reply.value_or(v1::OperatorReply());
}

std::vector<Played> RecorderRig::content(const std::string& path, const std::string& topic) {
  auto tape = recorder::Tape::open({path}, [&](const std::string& name) {
    return topic.empty() ? !name.starts_with("service/") && !name.starts_with("operator/") &&
                               name != "lab/beacon"
                         : name == topic;
  });
  EXPECT_TRUE(tape) << tape.error().message();
  std::vector<Played> all;
  while (tape) {
    auto one = tape->next();
    if (!one) break;
    all.push_back(std::move(*one));
  }
  if (tape) tapes_.push_back(std::move(*tape));
  return all;
}

v1::ObjectDetection RecorderRig::detection(std::uint32_t track, std::uint64_t number) {
  v1::ObjectDetection message;
  message.track(track);
  message.sequence_number(number);
  message.stamp_ns(now_ns());
  message.name("Cup");
  return message;
}

}  // namespace prehend::integration
