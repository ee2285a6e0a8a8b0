#include "common/robot/gatekeeper.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "common/base/log.hpp"
#include "common/convert/convert.hpp"
#include "common/dds/topics.hpp"
#include "common/robot/bounded_text.hpp"

namespace prehend::robot {
namespace {

constexpr Duration start_up = std::chrono::seconds(3);  // until some come
constexpr std::size_t max_counts = 32;                  // idl/Robot.idl
constexpr std::int64_t max_buttons = 8;
constexpr const char* target_name = "gate";

gate::Command from_message(const v2::HandCommand& message, const dds::SampleInfo& info) {
  Pose nowhere;
  nowhere.matrix().setConstant(std::numeric_limits<double>::quiet_NaN());
  gate::Command command;
  command.writer = info.participant;
  command.sequence = message.sequence_number();
  command.stamp = from_ns(message.stamp_ns());
  command.hand = message.hand().to_string();
  command.model = message.model().to_string();
  command.place = {convert::from_message(message.dof()),
                   convert::from_message(message.X_WB()).value_or(nowhere),
                   convert::from_message(message.effort())};
  return command;
}

/// Whose order it is, and for what: nobody's reply stands for another's, nor for another order.
std::string owner_of(const v1::OperatorCommand& order, const dds::SampleInfo& info) {
  return fmt::format("{} {:02x}", static_cast<int>(order.action()),
                     fmt::join(info.participant, "."));
}

/// A robot that is real, unless somebody has said otherwise.
bool wants_consent(const service::Config& config, bool real) {
  return config.is_given("safety.deadman") ? config.flag("safety.deadman") : real;
}

gate::Limits limits_of(const model::HandModel& hand, const service::Config& config) {
  gate::Limits limits = gate::limits_of(hand);
  limits.base = {config.number("gate.base_speed"), config.number("gate.base_acceleration")};
  limits.turn = {config.number("gate.base_turn_speed"),
                 config.number("gate.base_turn_acceleration")};
  // What is no share is refused, as one of 0 is.
  const double share = config.number("gate.effort");
  limits.effort *= share <= 1 ? share : 0;
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
  const std::string& on_stop = config.text("safety.on_stop");
  if (on_stop != "hold" && on_stop != "open")
    return wrong_use("is neither hold nor open", "safety.on_stop");
  if (const auto button = config.integer("safety.button"); button < 0 || button > max_buttons)
    return wrong_use("is no button", "safety.button", "1 to 8; 0: none gives consent");
  auto gate = gate::CommandGate::create(hand,
                                        {.hand = name,
                                         .max_age = seconds(config.number("gate.max_age")),
                                         .max_silence = seconds(config.number("gate.max_silence")),
                                         .deadman = wants_consent(config, robot.is_real)},
                                        limits_of(hand, config), robot.where);
  if (!gate) {
    gate.error().exit = exit_wrong_use;
    return tl::unexpected(gate.error());
  }
  std::unique_ptr<Gatekeeper> made(
      new Gatekeeper(shell, hand, name, std::move(*gate), std::move(robot)));
  if (auto opened = made->open_audit(name); !opened) return tl::unexpected(opened.error());
  made->recall_stop(name);
  return made;
}

Gatekeeper::Gatekeeper(service::Shell& shell, const model::HandModel& hand, const std::string& name,
                       gate::CommandGate gate, Robot robot)
    : shell_(shell),
      robot_(std::move(robot)),
      gate_(std::move(gate)),
      open_{hand.clamp(hand.postures().at("open"))},
      opens_(shell.config().text("safety.on_stop") == "open"),
      states_(shell.publish(dds::robot_gate)),
      replies_(shell.publish(dds::operator_reply)),
      last_obeyed_(shell.now() + start_up),
      glove_(shell.config().text("glove.name")),
      button_(shell.config().integer("safety.button")) {
  consented_ = gate_.has_consent(shell_.now());
  put(state_.hand(), name, 64);
  state_.deadman(wants_consent(shell.config(), robot_.is_real));
  shell_.busy_while([this] { return leader_.has_value(); });
  if (shell_.config().flag("safety.start_stopped"))
    gate_.stop("safety.start_stopped", "not yet released", shell.now());
  shell_.subscribe(dds::robot_command, std::function([this](const v2::HandCommand& message,
                                                            const dds::SampleInfo& info) {
                     // Whoever commanded is gone: the hand holds still once its command is stale.
                     if (!info.gone) on_command(message, info);
                   }));
  shell_.subscribe(dds::operator_command, std::function([this](const v1::OperatorCommand& order,
                                                               const dds::SampleInfo& info) {
                     if (!info.gone) on_order(order, info);
                   }));
  shell_.subscribe(dds::operator_consent, std::function([this](const v1::OperatorConsent& consent,
                                                               const dds::SampleInfo& info) {
                     if (!info.gone) on_consent(consent, info);
                   }));
  if (button_ != 0)
    shell_.subscribe(dds::glove_button, std::function([this](const v1::GloveButton& button,
                                                             const dds::SampleInfo& info) {
                       if (!info.gone) on_button(button, info);
                     }));
}

Gatekeeper::~Gatekeeper() {
  const Time now = shell_.now();
  if (audit_) audit_->flush(now, true);
  note(audit::Event::end, "", "", now);
}

void Gatekeeper::tick(Time now) {
  watch_consent(now);
  watch_lead(now);
  if (audit_ && !audit_->flush(now)) shell_.status().drop("audit not written");
  // The gate lets it go from where it rests: a base that brakes harder than it may accelerate would
  // be ahead of that, and come back.
  if (gate_.stopped() && opens_ && robot_.rests())
    if (const auto here = robot_.where())
      robot_.go(gate_.go({open_.dof, here->X_WB}, now).place, now);
  if (shell_.lockstep()) return;
  look_around(now);
  tell(now);
}

Expected<void> Gatekeeper::open_audit(const std::string& name) {
  const auto folder = shell_.config().path("safety.audit");
  if (folder.empty()) return {};
  auto log = audit::Log::open({.folder = folder, .name = name});
  if (!log) return tl::unexpected(log.error());
  audit_.emplace(std::move(*log));
  note(audit::Event::begin, "", "", shell_.now());
  return {};
}

void Gatekeeper::recall_stop(const std::string& name) {
  if (shell_.lockstep()) return;
  auto kept = KeptStop::create(shell_.config(), name);
  if (!kept) return log::warning("a stop would end with this process: {}", kept.error().message());
  kept_.emplace(std::move(*kept));
  const auto stop = kept_->recall();
  if (!stop) return;
  gate_.release();  // of safety.start_stopped, which knows less
  // A file may say any time; a release must be able to come after it.
  gate_.stop(stop->by, stop->reason, std::min(stop->since, shell_.now()));
  note(audit::Event::stop, stop->by, stop->reason, shell_.now());
  log::warning("still stopped by {}{}{}; prehend release ends it", stop->by,
               stop->reason.empty() ? "" : ": ", stop->reason);
}

Expected<void> Gatekeeper::keep_stop() {
  if (shell_.lockstep()) return {};
  if (!kept_) return fail("there is no folder for it", "safety.state");
  return kept_->keep(*gate_.stopped());
}

void Gatekeeper::note(audit::Event event, const std::string& who, const std::string& what,
                      Time now) {
  if (audit_ && !audit_->write({now, state_.hand().to_string(), event, who, what}))
    shell_.status().drop("audit not written");
}

void Gatekeeper::note_refused(audit::Event event, std::string_view reason,
                              const gate::WriterId& writer, Time now) {
  if (audit_ && !audit_->refuse(
                    {now, state_.hand().to_string(), event, name_of(writer), std::string(reason)}))
    shell_.status().drop("audit not written");
}

// --- commands

void Gatekeeper::on_command(const v2::HandCommand& message, const dds::SampleInfo& info) {
  if (std::ranges::find(robot_.beside, message.hand().to_string()) != robot_.beside.end()) return;
  const Time now = shell_.now();
  const auto passed = gate_.admit(from_message(message, info), now);
  const bool ours = passed || passed.error() != gate::Refusal::another_hand;
  if (ours) writers_.heard(info.participant, now);
  watch_lead(now);
  if (passed)
    obey(message, info, *passed, now);
  else
    refuse(passed.error(), info, now);
}

/// Says and notes who leads, and who leads no more. Nobody leads a hand that is stopped.
void Gatekeeper::watch_lead(Time now) {
  if (gate_.leads() != leads_) {
    shell_.status().count("leads", gate_.leads() - leads_);
    leads_ = gate_.leads();
  }
  const auto leader = gate_.stopped() ? std::nullopt : gate_.leader(now);
  if (leader == leader_) return;
  if (leader_) note(audit::Event::lead_end, leader_name_, "", now);
  leader_ = leader;
  if (!leader) return;
  leader_name_ = name_of(*leader);
  log::info("{} leads the hand", leader_name_);
  note(audit::Event::lead, leader_name_, "", now);
}

void Gatekeeper::count(std::string_view reason) {
  shell_.status().drop(reason);
  const auto known = counts_.find(reason);
  if (known != counts_.end())
    ++known->second;
  else if (counts_.size() < max_counts)
    counts_.emplace(std::string(reason), 1);
}

void Gatekeeper::refuse(gate::Refusal refusal, const dds::SampleInfo& info, Time now) {
  count(to_string(refusal));
  note_refused(audit::Event::refused, to_string(refusal), info.participant, now);
  // What is for another hand, or comes while it must not move, is no fault of the commands.
  if (refusal == gate::Refusal::another_hand || refusal == gate::Refusal::stopped ||
      refusal == gate::Refusal::no_consent)
    return;
  const Refused refused{std::string(to_string(refusal)), info.participant, now};
  (refusal == gate::Refusal::second_writer ? second_ : refused_) = refused;
}

void Gatekeeper::obey(const v2::HandCommand& message, const dds::SampleInfo& info,
                      const gate::Passed& passed, Time now) {
  for (std::size_t i = 0; i < gate::cuts; ++i)
    if (passed.cut[i]) {
      count(to_string(static_cast<gate::Cut>(i)));
      note_refused(audit::Event::refused, to_string(static_cast<gate::Cut>(i)), info.participant,
                   now);
    }
  if (auto obeyed = robot_.obey(message, passed.place, now); !obeyed) {
    // The hand has not gone where the gate let it.
    gate_.start_anew();
    count(obeyed.error().what);
    refused_ = Refused{obeyed.error().what, info.participant, now};
    return;
  }
  last_obeyed_ = now;
  ++obeyed_;
  shell_.status().count("commands");
  if (message.origin_ns() != 0)  // a hand that is told to hold still answers no glove frame
    shell_.status().latency("glove to accepted", now - from_ns(message.origin_ns()));
  shell_.status().latency("command hop", now - info.sent);
}

// --- orders

void Gatekeeper::on_order(const v1::OperatorCommand& order, const dds::SampleInfo& info) {
  const std::string target = order.target().to_string();
  if (!target.empty() && target != target_name) return;
  const auto action = order.action();
  if (action != v1::ACTION_STOP && action != v1::ACTION_RELEASE && action != v1::ACTION_TAKE_OVER)
    return;
  const Time now = shell_.now();
  const std::string by = service::given_by(order, shell_.writer_of(info));
  const std::string owner = owner_of(order, info);
  if (const auto known = orders_.find(order.id().to_string(), owner))
    return replies_.publish(*known);
  const auto executed = execute(order, by, shell_.role_of(info), now);
  v1::OperatorReply reply;
  reply.id(order.id());
  reply.stamp_ns(to_ns(now));
  reply.service(target_name);
  reply.done(executed.has_value());
  put(reply.message(), executed ? *executed : executed.error().message(), 255);
  // One that was refused may be given again, when clocks are known or the writer has come.
  if (executed) orders_.add(reply, owner);
  if (!executed) {
    shell_.status().drop("order refused");
    // It is repeated until it expires. What it says beside the reason is the sender's to choose.
    if (orders_.refuse(order.id().to_string()))
      note_refused(audit::Event::order_refused, executed.error().what, info.participant, now);
  }
  replies_.publish(reply);
  if (!shell_.lockstep()) {
    look_around(now);
    tell(now);
  }
}

/// A stop is obeyed from whom and whenever it comes.
Expected<std::string> Gatekeeper::execute(const v1::OperatorCommand& order, const std::string& by,
                                          std::optional<dds::Role> role, Time now) {
  const std::string argument = order.argument().to_string();
  if (order.action() == v1::ACTION_STOP) return stop(by, argument, now);
  if (!shell_.lockstep())
    if (const auto meant = service::meant_now(order, by, role, now); !meant)
      return tl::unexpected(meant.error());
  return order.action() == v1::ACTION_RELEASE
             ? release(by, argument, from_ns(order.stamp_ns()), now)
             : take_over(by, argument, now);
}

std::string Gatekeeper::stop(const std::string& by, const std::string& reason, Time now) {
  const bool already = gate_.stopped().has_value();
  gate_.stop(by, reason, now);
  if (!already) robot_.hold();
  const auto kept = keep_stop();
  if (!kept) log::warning("the stop ends with this process: {}", kept.error().message());
  if (already)
    return fmt::format("stopped already, by {}{}{}", gate_.stopped()->by,
                       gate_.stopped()->reason.empty() ? "" : ": ", gate_.stopped()->reason);
  shell_.status().count("stops");
  watch_lead(now);
  note(audit::Event::stop, by, reason, now);
  log::warning("stopped by {}{}{}", by, reason.empty() ? "" : ": ", reason);
  return fmt::format("stopped; the hand {}{}", opens_ ? "opens" : "holds",
                     kept ? "" : ", until this process ends: " + kept.error().message());
}

void Gatekeeper::fault(const std::string& reason, Time now) {
  if (gate_.stopped()) return gate_.stop("the robot itself", reason, now);
  stop("the robot itself", reason, now);
  if (!shell_.lockstep()) {
    look_around(now);
    tell(now);
  }
}

void Gatekeeper::start_anew() {
  gate_.start_anew();
}

Expected<std::string> Gatekeeper::release(const std::string& by, const std::string& reason,
                                          Time given, Time now) {
  if (reason.empty()) return fail("a release needs a reason", by);
  if (!gate_.stopped()) return "was not stopped";
  if (!shell_.lockstep() && !gate_.may_release(given))
    return fail("the release was given before the stop", by, "look again, then release anew");
  if (kept_)
    if (const auto gone = kept_->forget(); !gone)
      log::warning("the next process is stopped again: {}", gone.error().message());
  robot_.hold();
  gate_.release();
  put(state_.reason(), reason, 127);
  state_.since_ns(to_ns(now));
  last_obeyed_ = now;
  note(audit::Event::release, by, reason, now);
  log::warning("released by {}: {}", by, reason);
  return "released";
}

Expected<std::string> Gatekeeper::take_over(const std::string& by, const std::string& name,
                                            Time now) {
  const auto meant = writers_.named(
      name, gate_.leader(now), now, [this](const auto& writer) { return name_of(writer); },
      dds::robot_command.name);
  if (!meant) return tl::unexpected(meant.error());
  robot_.hold();
  note(audit::Event::takeover, by, name_of(*meant), now);
  gate_.take_over(*meant, now);
  watch_lead(now);
  return name_of(*meant) + (gate_.stopped() ? " leads after the release" : " leads");
}

// --- consent

void Gatekeeper::on_consent(const v1::OperatorConsent& consent, const dds::SampleInfo& info) {
  if (consent.hand().to_string() == state_.hand().to_string())
    this->consent(consent.held(), from_ns(consent.stamp_ns()), info, dds::operator_consent);
}

void Gatekeeper::on_button(const v1::GloveButton& button, const dds::SampleInfo& info) {
  if (button.glove().to_string() != glove_) return;
  const auto& held = button.held();
  consent(std::find(held.begin(), held.end(), button_) != held.end(), from_ns(button.stamp_ns()),
          info, dds::glove_button);
}

void Gatekeeper::consent(bool held, Time stamp, const dds::SampleInfo& info,
                         const dds::TopicInfo& topic) {
  // What somebody consented to then is not consent now.
  if (!shell_.lockstep() && !service::means(shell_.role_of(info), topic))
    return shell_.status().drop("consent of nobody who may give it");
  const Time now = shell_.now();
  gate_.consent(info.participant, held, stamp, now);
  watch_consent(now);
}

/// Without consent the hand stays at once, not only when the next command is refused.
void Gatekeeper::watch_consent(Time now) {
  const bool has = gate_.has_consent(now);
  if (consented_ && !has) robot_.hold();
  if (consented_ != has && state_.deadman())
    note(has ? audit::Event::consent : audit::Event::consent_end, "", "", now);
  consented_ = has;
}

}  // namespace prehend::robot
