#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/audit/log.hpp"
#include "common/base/error.hpp"
#include "common/dds/participant.hpp"
#include "common/gate/command_gate.hpp"
#include "common/model/hand_model.hpp"
#include "common/robot/kept_stop.hpp"
#include "common/service/order_book.hpp"
#include "common/service/shell.hpp"
#include "common/service/writers.hpp"
#include "idl/Glove.h"
#include "idl/Robot.h"

namespace prehend::robot {

/// What the gate stands before, simulated or real. Called by the shell.
struct Robot {
  /// Obeys a command: `place` is what the gate has left of it.
  std::function<Expected<void>(const v2::HandCommand& command, const gate::Place& place, Time now)>
      obey;
  /// Where the hand is kept now; nothing as long as it may be put anywhere.
  std::function<std::optional<gate::Place>()> where;
  /// May it still be put anywhere, because nobody has led it yet and nothing carries it?
  std::function<bool()> is_placed = {};
  /// Stays where it is, at once; a grip keeps its squeeze.
  std::function<void()> hold;
  /// Has its base come to rest after that? Until then it is told to go nowhere.
  std::function<bool()> rests = [] { return true; };
  /// Goes there, though nobody commands it: to open while it is stopped.
  std::function<void(const gate::Place& place, Time now)> go;
  /// Other hands that the same process moves: a command for them is nobody's mistake.
  std::vector<std::string> beside = {};
  /// Can it hurt somebody? Then it wants consent unless safety.deadman says otherwise.
  bool is_real = false;
};

/// The gate between robot/command and a robot hand, with all that the lab hears of it: the latched
/// stop and other orders, robot/gate, counts of what was refused or cut, and a status that says
/// whether the hand is led. Every service that moves a hand has one.
class Gatekeeper {
 public:
  /// hand: key of its topics. Both references must outlive it.
  static Expected<std::unique_ptr<Gatekeeper>> create(service::Shell& shell,
                                                      const model::HandModel& hand,
                                                      const std::string& name, Robot robot);

  /// From the service's tick.
  void tick(Time now);
  /// Something is wrong with the robot: it is stopped, as by an operator, until somebody releases
  /// it.
  void fault(const std::string& reason, Time now);
  bool is_stopped() const { return gate_.stopped().has_value(); }
  /// May it move by itself, to home? Not while it is stopped, nor without the consent that is asked
  /// for.
  bool may_move(Time now) const { return !is_stopped() && gate_.has_consent(now); }
  /// The robot did not follow, or nobody knew where it was: the next command counts from where it
  /// is.
  void start_anew();

  ~Gatekeeper();

 private:
  Gatekeeper(service::Shell& shell, const model::HandModel& hand, const std::string& name,
             gate::CommandGate gate, Robot robot);
  void on_command(const v2::HandCommand& message, const dds::SampleInfo& info);
  void refuse(gate::Refusal refusal, const dds::SampleInfo& info, Time now);
  void obey(const v2::HandCommand& message, const dds::SampleInfo& info, const gate::Passed& passed,
            Time now);
  void count(std::string_view reason);

  void on_order(const v1::OperatorCommand& order, const dds::SampleInfo& info);
  Expected<std::string> execute(const v1::OperatorCommand& order, const std::string& by,
                                std::optional<dds::Role> role, Time now);
  std::string stop(const std::string& by, const std::string& reason, Time now);
  /// given: when the operator did.
  Expected<std::string> release(const std::string& by, const std::string& reason, Time given,
                                Time now);
  Expected<std::string> take_over(const std::string& by, const std::string& name, Time now);

  void on_consent(const v1::OperatorConsent& consent, const dds::SampleInfo& info);
  void on_button(const v1::GloveButton& button, const dds::SampleInfo& info);
  /// Consent of somebody, unless it is only played.
  void consent(bool held, Time stamp, const dds::SampleInfo& info, const dds::TopicInfo& topic);
  void watch_consent(Time now);
  void watch_lead(Time now);
  Expected<void> open_audit(const std::string& name);
  /// Stopped as the process before was.
  void recall_stop(const std::string& name);
  /// So that whoever comes after this process is stopped as well; else why not.
  Expected<void> keep_stop();
  /// A line of the audit log, where there is one.
  void note(audit::Event event, const std::string& who, const std::string& what, Time now);
  /// One of perhaps very many: the first of its kind, then their number.
  void note_refused(audit::Event event, std::string_view reason, const gate::WriterId& writer,
                    Time now);

  std::string missing(Time now) const;
  void look_around(Time now);
  void tell(Time now);
  std::string name_of(const gate::WriterId& writer) const;

  /// A command that was not obeyed.
  struct Refused {
    std::string why;
    gate::WriterId writer{};
    Time at{};
  };

  service::Shell& shell_;
  std::optional<audit::Log> audit_;
  Robot robot_;
  gate::CommandGate gate_;
  gate::Place open_;    // dof: of the open hand
  bool opens_ = false;  // at a stop
  service::Shell::Output<v1::GateState> states_;
  service::Shell::Output<v1::OperatorReply> replies_;
  std::optional<KeptStop> kept_;
  service::OrderBook orders_;
  std::uint64_t leads_ = 0;         // as counted in the status
  service::Writers writers_;        // of commands for this hand
  Time last_obeyed_;                // or when somebody must have commanded at last
  std::optional<Refused> refused_;  // the last one
  std::optional<Refused> second_;   // of a second writer
  std::string missing_;
  v1::GateState state_;  // as it was told last
  std::map<std::string, std::uint64_t, std::less<>> counts_;
  std::optional<gate::WriterId> leader_;  // as noted
  std::string leader_name_;
  bool consented_ = false;
  std::string glove_;        // whose button is the deadman
  std::int64_t button_ = 0;  // its number; 0: none
  std::uint64_t obeyed_ = 0;
  Time next_state_{};
};

}  // namespace prehend::robot
