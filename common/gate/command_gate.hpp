#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "common/gate/motion_limiter.hpp"
#include "common/model/hand_model.hpp"

namespace prehend::gate {

/// Who wrote: the first bytes of the identity of a DDS writer, its participant.
using WriterId = std::array<std::uint8_t, 12>;

/// A command as it came.
struct Command {
  WriterId writer{};
  std::uint64_t sequence = 0;  // by its writer; one who does not count has always the same
  Time stamp{};                // by the clock here
  std::string hand, model;
  Place place;
};

/// Why a command is not obeyed.
enum class Refusal {
  not_finite,
  another_hand,
  another_model,
  wrong_length,
  far_away,
  outside_limits,
  too_old,
  from_future,
  not_newer,
  second_writer,
  stopped,
  no_consent
};
std::string_view to_string(Refusal refusal);

struct GateOptions {
  /// Key of the hand's topics: commands for another hand are refused.
  std::string hand;
  /// A command is refused that is older than this, or as far ahead of now.
  Duration max_age = std::chrono::milliseconds(200);
  /// A leader that has been silent for so long leads no more.
  Duration max_silence = std::chrono::milliseconds(300);
  /// Nothing is obeyed without consent.
  bool deadman = false;
  /// Consent counts for so long after it was given.
  Duration max_consent_age = std::chrono::milliseconds(100);
};

/// Stands before a robot hand, simulated or real, and decides which commands it obeys. One writer
/// leads; what it says is passed on unchanged as long as it is within the limits. Pure: all times
/// are those of the robot's side. Keeps a reference to the hand.
class CommandGate {
 public:
  /// Where the hand is kept at the moment; asked when a writer begins to lead. Nothing: its first
  /// command says so.
  using Where = std::function<std::optional<Place>()>;

  static Expected<CommandGate> create(const model::HandModel& hand, GateOptions options,
                                      Limits limits, Where where = {});

  /// What is left of the command to obey, or why it is not obeyed at all.
  tl::expected<Passed, Refusal> admit(const Command& command, Time now);

  /// Who leads; a second one is refused until that one has been silent.
  std::optional<WriterId> leader(Time now) const;
  /// From now on this writer leads, whoever led before.
  void take_over(const WriterId& writer, Time now);
  /// Nothing is obeyed any more until the release. A stop that is there already stays as it is.
  void stop(const std::string& by, const std::string& reason, Time now);
  /// The stop is over.
  void release();
  /// The next command counts from where the hand is, however it came there.
  void start_anew() { starts_ = true; }
  /// A release that was given then: not before the last stop, of which whoever gave it knew
  /// nothing.
  bool may_release(Time given) const;
  /// Somebody holds the deadman, or lets it go. Only who held it last can let it go. What is older
  /// than something else that he has said is nothing.
  void consent(const WriterId& writer, bool held, Time stamp, Time now);
  /// There is consent, or none is asked for.
  bool has_consent(Time now) const;

  struct Stop {
    std::string by, reason;
    Time since{};
    Time newest{};  // when it was asked for last
  };
  const std::optional<Stop>& stopped() const { return stop_; }
  /// While it is stopped: how far the hand may go by now on its way to a place of its own choice.
  Passed go(const Place& place, Time now);

  /// How often the lead has changed hands.
  std::uint64_t leads() const { return leads_; }

 private:
  struct Heard {
    std::uint64_t sequence = 0;
    Time stamp{}, at{};
  };
  CommandGate(const model::HandModel& hand, GateOptions options, Limits limits, Where where);
  std::optional<Refusal> judge(const Command& command, Time now);
  std::optional<Refusal> judge_content(const Command& command) const;
  bool is_newer(const Command& command, Time now);
  bool make_room(const WriterId& writer, Time now);
  void lead(const WriterId& writer);
  void start();

  const model::HandModel& hand_;
  GateOptions options_;
  MotionLimiter motion_;
  Where where_;
  std::map<WriterId, Heard> heard_;  // the newest of each writer
  std::optional<WriterId> leader_;
  Time led_{};  // its last command that was in order
  std::optional<Stop> stop_;
  std::optional<WriterId> holder_;  // of the deadman
  Time held_{};                     // when that came
  std::map<WriterId, Time> told_;   // of the deadman: the newest stamp of each
  bool starts_ = true;              // the next command is the first of a lead
  std::uint64_t leads_ = 0;
};

}  // namespace prehend::gate
