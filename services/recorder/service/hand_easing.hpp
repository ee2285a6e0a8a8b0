#pragma once

#include <optional>
#include <string>

#include "common/dds/topics.hpp"
#include "common/model/hand_model.hpp"
#include "services/recorder/core/ease_in.hpp"
#include "services/recorder/service/tape.hpp"

namespace prehend::recorder {

/// Commands that move a robot hand from where it is to where the first command of a recording has
/// it, so that a player may begin there.
class HandEasing {
 public:
  /// Finds the next command for the hand on the tape.
  static Expected<HandEasing> create(Tape& tape, const std::string& hand);

  std::string hand() const { return command_.hand().to_string(); }
  bool begun() const { return way_.has_value(); }
  /// The first state begins the way.
  void on_state(const v1::HandState& state, Time now);
  /// The command for now, as the writer of the tape's would have sent it; once it has begun.
  dds::RawSample command(Time now);
  bool has_arrived(Time now) const { return begun() && now - began_ >= way_->duration(); }
  /// Whose writer sends the commands.
  const recording::Stream& stream() const { return *first_.stream; }

 private:
  HandEasing(Played first, const v2::HandCommand& command, model::HandModel model, HandPlace to);

  Played first_;
  v2::HandCommand command_;
  model::HandModel model_;
  HandPlace to_;
  std::optional<EaseIn> way_;
  Time began_{};
};

}  // namespace prehend::recorder
