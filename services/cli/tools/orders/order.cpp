#include "services/cli/tools/orders/order.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/base/log.hpp"
#include "common/base/printable.hpp"
#include "common/dds/topics.hpp"
#include "common/service/shell.hpp"
#include "common/tool/keyboard.hpp"

namespace prehend::cli {
namespace {

/// Between two tries, until all have answered: who is only just being discovered hears a later one.
constexpr Duration order_period = std::chrono::milliseconds(50);
constexpr Duration key_period = std::chrono::milliseconds(5);
/// Once all gates that are known have answered, others may still turn up for so long: in a rig, and
/// in a whole domain, where everybody announces himself several times meanwhile.
constexpr Duration grace = std::chrono::milliseconds(300),
                   grace_of_all = std::chrono::milliseconds(1200);
constexpr Duration patience = std::chrono::seconds(1);
constexpr const char* gate_name = "gate";

/// Of a process that was heard of in the rig: of its gates, one for each hand, or of a mapping.
struct Answer {
  std::optional<v1::OperatorReply> reply;       // the last one
  std::size_t done = 0;                         // replies in a row that say so: each gate gives one
  std::map<std::string, v1::GateState> states;  // by hand
};

bool is_done(const Answer& answer) {
  return answer.reply && answer.done >= std::max<std::size_t>(1, answer.states.size());
}

/// Only what tells of a gate, on a topic that nobody else may write, answers for one; anybody may
/// reply. Mapping answers a takeover as well.
bool counts(const Order& order, const Answer& answer) {
  return !answer.states.empty() || (order.action == v1::ACTION_TAKE_OVER && answer.reply);
}

/// Gives one order in one rig.
class Giving {
 public:
  Giving(service::Shell& shell, const Order& order, std::string rig)
      : shell_(shell),
        order_(order),
        rig_(std::move(rig)),
        id_(fmt::format("{}-{}-{}", operator_name(), ::getpid(), to_ns(shell.now()))),
        begun_(shell.now()),
        orders_(shell.publish(dds::operator_command)) {
    if (order.on_key) {
      keyboard_.emplace();
      log::info("any key stops; Ctrl-C ends without that");
    }
    shell.subscribe(dds::operator_reply, std::function([this](const v1::OperatorReply& reply,
                                                              const dds::SampleInfo& info) {
                      if (info.gone || reply.id().to_string() != id_ || !is_meant(reply)) return;
                      Answer& heard = answer(info);
                      heard.done = reply.done() ? heard.done + 1 : 0;
                      heard.reply = reply;
                    }));
    shell.subscribe(dds::robot_gate,
                    std::function([this](const v1::GateState& state, const dds::SampleInfo& info) {
                      if (info.gone) return;
                      Answer& heard = answer(info);
                      const std::string hand = state.hand().to_string();
                      if (!heard.states.contains(hand)) newest_ = shell_.now();
                      heard.states[hand] = state;
                    }));
    shell.on_tick(keyboard_ ? key_period : order_period, [this](Time now) { tick(now); });
    shell.status().running();
  }

  std::vector<Answer> sorted_answers() const {
    std::vector<Answer> all;
    for (const auto& [participant, answer] : answers_)
      if (counts(order_, answer)) all.push_back(answer);
    std::stable_partition(all.begin(), all.end(), [](auto& one) { return !one.states.empty(); });
    return all;
  }

 private:
  bool is_meant(const v1::OperatorReply& reply) const {
    return order_.action == v1::ACTION_TAKE_OVER || reply.service().to_string() == gate_name;
  }

  Answer& answer(const dds::SampleInfo& info) {
    if (!answers_.contains(info.participant)) newest_ = shell_.now();
    return answers_[info.participant];
  }

  /// By all, but for a takeover: the new leader leads one hand, and others do not know it.
  bool is_given() const {
    const std::vector<Answer> all = sorted_answers();
    if (order_.action == v1::ACTION_TAKE_OVER) return std::any_of(all.begin(), all.end(), is_done);
    return !all.empty() && std::all_of(all.begin(), all.end(), is_done);
  }

  /// Somebody is here who may have a gate in the rig, and none was heard of yet. A participant is
  /// met at once, its topics a moment later, or seconds where the network loses packets.
  bool lacks_gates() const {
    return std::ranges::any_of(shell_.present(), [this](const auto& entry) {
      const auto& [participant, peer] = entry;
      if (!peer.role || !dds::robot_gate.writers.has(*peer.role)) return false;
      const bool elsewhere = rig_ != "*" && !peer.rigs.empty() && !peer.rigs.contains(rig_);
      return !elsewhere && !answers_.contains(participant);
    });
  }

  void tick(Time now) {
    if (keyboard_ && !pressed_) {
      pressed_ = keyboard_->key().has_value();
      if (!pressed_) return;
      begun_ = now;
    }
    const bool given = is_given() && !lacks_gates();
    // What a gate says of itself comes right behind its reply.
    const bool told = std::all_of(answers_.begin(), answers_.end(), [](auto& entry) {
      const Answer& one = entry.second;
      return !one.states.empty() || (one.reply && one.reply->service().to_string() != gate_name);
    });
    const bool over = now - begun_ > seconds(order_.timeout);
    // Whoever replies as a gate and tells of none holds nobody up for longer than that.
    const bool settled =
        (told || now - newest_ > patience) && now - newest_ > (rig_ == "*" ? grace_of_all : grace);
    if ((given && settled) || over) return shell_.stop();
    v1::OperatorCommand message;
    message.id(id_.substr(0, 63).c_str());
    // When it was given, however often it is repeated: a release must not end a later stop.
    message.stamp_ns(to_ns(begun_));
    message.action(order_.action);
    // Mapping chooses between gloves, a gate between those who send commands.
    if (order_.action != v1::ACTION_TAKE_OVER) message.target(gate_name);
    message.argument(order_.argument.substr(0, 127).c_str());
    if (given || now - sent_ < order_period / 2) return;
    sent_ = now;
    orders_.publish(message);
  }

  service::Shell& shell_;
  const Order& order_;
  std::string rig_, id_;
  Time begun_, newest_{}, sent_{};
  std::optional<tool::Keyboard> keyboard_;  // that is waited for
  bool pressed_ = false;
  service::Shell::Output<v1::OperatorCommand> orders_;
  std::map<dds::GuidPrefix, Answer> answers_;
};

/// A line, and an entry of the document, a gate, or the mapping; true: it did what was asked.
bool report(const std::string& rig, const Answer& answer, bool json,
            nlohmann::ordered_json& document) {
  const bool done = is_done(answer);
  const std::string service = answer.reply ? answer.reply->service().to_string() : gate_name;
  const std::string message =
      answer.reply ? answer.reply->message().to_string() : "does not answer";
  std::map<std::string, v1::GateState> states = answer.states;
  if (states.empty()) states[""];
  for (const auto& [hand, state] : states) {
    document.push_back({{"rig", rig},
                        {"service", service},
                        {"hand", hand},
                        {"done", done},
                        {"message", message},
                        {"stopped", state.stopped()},
                        {"leader", state.leader().to_string()}});
    if (!json)
      std::cout << fmt::format("{}/{}: {}\n", rig, printable(hand.empty() ? service : hand),
                               printable(message));
  }
  return done;
}

/// True: all gates of the rig did what was asked, and there is one.
Expected<bool> give_in(const std::string& rig, const Order& order,
                       nlohmann::ordered_json& document) {
  std::vector<std::string> arguments = order.lab.for_service();
  arguments.insert(arguments.end(), {"--set", "lab.rig=" + rig});
  const auto shell =
      service::Shell::create(arguments, {operator_name(), "Gives an order.", "operator", false});
  if (!shell) return tl::unexpected(shell.error());
  const Giving giving(**shell, order, rig);
  if (const auto ended = (*shell)->run(); !ended) return tl::unexpected(ended.error());
  // Gates first. Where somebody has taken over, those who do not know him matter to nobody.
  const auto all = giving.sorted_answers();
  const bool taken_over =
      order.action == v1::ACTION_TAKE_OVER && std::any_of(all.begin(), all.end(), is_done);
  std::size_t done = 0;
  for (const Answer& answer : all)
    if (!taken_over || is_done(answer)) done += report(rig, answer, order.json, document);
  if (all.empty() && !order.json)
    std::cout << fmt::format("{}: no gate answers; is a robot there? prehend status\n", rig);
  return done > 0 && (done == all.size() || order.action == v1::ACTION_TAKE_OVER);
}

}  // namespace

void Order::add_to(CLI::App& app) {
  lab.add_to(app);
  auto* one = app.add_option("--rig", rigs, "another rig than lab.rig; repeatable")
                  ->type_size(1)
                  ->allow_extra_args(false);
  app.add_flag("--all", all, "every rig of the domain")->excludes(one);
  app.add_option("--timeout", timeout, "s to wait for answers")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 3600.0));
  app.add_flag("--json", json, "one JSON document on standard output");
}

std::string operator_name() {
  const char* user = std::getenv("USER");
  const std::string name = user && *user ? user : std::to_string(::getuid());
  return "operator-" + name.substr(0, 40);  // of the 64 characters of a service's name
}

int give(const Order& order) {
  const auto config = order.lab.load();
  if (!config) return service::complain(config.error(), exit_wrong_use);
  std::vector<std::string> rigs = order.rigs;
  if (rigs.empty()) rigs.push_back(order.all ? "*" : config->text("lab.rig"));
  nlohmann::ordered_json gates = nlohmann::ordered_json::array();
  bool all = true;
  for (const std::string& rig : rigs) {
    const auto done = give_in(rig, order, gates);
    if (!done) return service::complain(done.error());
    all = all && *done;
  }
  if (order.json)
    std::cout << nlohmann::ordered_json{{"done", all}, {"gates", gates}}.dump(
                     -1, ' ', false, nlohmann::json::error_handler_t::replace)
              << "\n";
  return all ? exit_done : exit_no;
}

}  // namespace prehend::cli
