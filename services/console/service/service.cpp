#include "services/console/service/service.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <iostream>
#include <utility>

#include "common/base/clock.hpp"
#include "common/base/log.hpp"
#include "common/service/membership.hpp"
#include "services/console/service/setup.hpp"

namespace prehend::console {
namespace {

v1::OperatorAction action_of(OrderKind kind) {
  switch (kind) {
    case OrderKind::start:
      return v1::ACTION_START;
    case OrderKind::stop:
      return v1::ACTION_STOP;
    case OrderKind::release:
      return v1::ACTION_RELEASE;
    case OrderKind::set_mode:
      return v1::ACTION_SET_MODE;
    case OrderKind::take_over:
      return v1::ACTION_TAKE_OVER;
    case OrderKind::place:
      return v1::ACTION_PLACE_OBJECT;
    case OrderKind::teach:
      return v1::ACTION_TEACH;
  }
  return v1::ACTION_STOP;
}

std::vector<bool> topics_that_keep_all() {
  std::vector<bool> keeps;
  for (const dds::TopicInfo& topic : dds::topic_table) keeps.push_back(topic.qos.reader_depth == 0);
  return keeps;
}

}  // namespace

Expected<std::unique_ptr<Service>> Service::create(service::Shell& shell) {
  if (shell.lockstep())
    return wrong_use("the console shows a lab that is live", "lab.lockstep",
                     "or a recording: --recording FILE");
  std::unique_ptr<Service> made(new Service(shell));
  if (auto started = made->start(); !started) return tl::unexpected(started.error());
  return made;
}

Service::Service(service::Shell& shell)
    : shell_(shell),
      orders_(shell.publish(dds::operator_command)),
      consents_(shell.publish(dds::operator_consent)),
      mailbox_(topics_that_keep_all(), [this] { server_->wake(); }),
      graph_(shell.config().text("lab.rig")) {}

Service::~Service() {
  if (server_) server_->stop();
  if (thread_.joinable()) thread_.join();
  readers_.clear();
}

Expected<void> Service::start() {
  const service::Config& config = shell_.config();
  auto options = show_options();
  if (!options) return tl::unexpected(options.error());
  auto show = Show::create(config, std::move(*options));
  if (!show) return tl::unexpected(show.error());
  show_ = std::move(*show);
  auto served = serve(config, *show_);
  if (!served) return tl::unexpected(served.error());
  server_ = std::move(served->server);
  if (auto read = read_topics(); !read) return read;
  thread_ = std::thread([this] { server_->run(); });
  shell_.on_tick(std::chrono::seconds(1), [this](Time) {
    if (const auto lost = mailbox_.lost(); lost > told_lost_)
      shell_.status().drop("too many messages", lost - std::exchange(told_lost_, lost));
  });
  shell_.status().running();
  std::cout << served->address << std::endl;
  return {};
}

Expected<Show::Options> Service::show_options() {
  const service::Config& config = shell_.config();
  auto policy = policy_of(config);
  if (!policy) return tl::unexpected(policy.error());
  const auto X_WT = pose_of(config, "tracker.X_WT");
  if (!X_WT) return tl::unexpected(X_WT.error());
  Show::Options options{.policy = std::move(*policy),
                        .letters = [this] { return mailbox_.take(); },
                        .now_ns = [] { return to_ns(process_now()); },
                        .give = [this](const Order& order) { return give(order); },
                        .consent = [this](const Consent& said) { consent(said); },
                        .tracking = tracking_folder(),
                        .X_TW = X_WT->inverse(),
                        .graph = [this] { return graph_.changed(); }};
  if (auto glove = GloveLine::create(config)) {
    glove_ = std::move(*glove);
    options.hand = [this](const std::string& line) { glove_->send(line); };
  } else {
    options.no_hand = glove.error().message();
  }
  return options;
}

/// A participant of its own, as recorders have: its readers know no types.
Expected<void> Service::read_topics() {
  auto joining = service::membership(shell_.config(), "console-eye", "console");
  joining.listener = &graph_;
  auto joined = dds::Participant::create(joining);
  if (!joined) return tl::unexpected(joined.error());
  participant_.emplace(std::move(*joined));
  for (std::size_t i = 0; i < dds::topic_table.size(); ++i) {
    auto reader = dds::RawReader::create(
        *participant_, dds::raw_topic(dds::topic_table[i]),
        [this, i](dds::RawSample&& sample) { mailbox_.put(i, std::move(sample)); });
    if (!reader) return tl::unexpected(reader.error());
    readers_.push_back(std::move(*reader));
  }
  return {};
}

/// In the server's thread; the shell's writes it.
std::string Service::give(const Order& order) {
  v1::OperatorCommand message;
  const std::string id =
      fmt::format("console-{}-{}-{}", ::getpid(), to_ns(process_now()), given_++).substr(0, 63);
  message.id(id.c_str());
  message.stamp_ns(to_ns(process_now()));
  message.action(action_of(order.kind));
  message.target(order.target.c_str());
  message.argument(order.argument.c_str());
  if (order.kind == OrderKind::place) {
    message.X_WO().position().x(order.x);
    message.X_WO().position().y(order.y);
    message.X_WO().orientation().w(1);
  }
  log::info("order: {} for {} {}", id, order.target, order.argument);
  shell_.post([this, message] { orders_.publish(message); });
  return id;
}

/// In the server's thread. Stamped when it was heard: the gate counts from there.
void Service::consent(const Consent& said) {
  v1::OperatorConsent message;
  message.hand(said.hand.c_str());
  message.sequence_number(++consented_);
  message.stamp_ns(to_ns(process_now()));
  message.held(said.held);
  shell_.post([this, message] { consents_.publish(message); });
}

}  // namespace prehend::console
