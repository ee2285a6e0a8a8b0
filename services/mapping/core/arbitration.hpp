#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/time.hpp"

namespace prehend::mapping {

/// Who answers: the direct mapping alone, or how much the intelligent one.
enum class Phase {
  direct,    // weight 0
  engaging,  // weight rises
  engaged,   // weight 1
  gripping,  // touches: object and placement stay with the hand, whatever the camera sees
  leaving    // weight falls
};

enum class Event {
  in_reach,  // an object is within reach of the hand
  lost,      // the object is gone, stale, or out of reach
  touched,   // a robot finger is stopped by something
  released,  // no finger is any more
  full,      // the weight has reached 1
  empty      // the weight has reached 0
};

struct Transition {
  Phase from;
  Event event;
  Phase to;
};

/// All there is; any other event changes nothing.
inline constexpr std::array transitions{
    Transition{Phase::direct, Event::in_reach, Phase::engaging},
    Transition{Phase::engaging, Event::full, Phase::engaged},
    Transition{Phase::engaging, Event::lost, Phase::leaving},
    Transition{Phase::engaging, Event::touched, Phase::gripping},
    Transition{Phase::engaged, Event::lost, Phase::leaving},
    Transition{Phase::engaged, Event::touched, Phase::gripping},
    Transition{Phase::gripping, Event::released, Phase::engaging},
    Transition{Phase::leaving, Event::in_reach, Phase::engaging},
    Transition{Phase::leaving, Event::touched, Phase::gripping},
    Transition{Phase::leaving, Event::empty, Phase::direct},
};

std::string_view to_string(Phase phase);
std::string_view to_string(Event event);

/// The table as a Mermaid state diagram, as in README.md.
std::string drawing();

/// The state machine above with the weight of the intelligent answer, 0 to 1, which moves at a
/// constant rate. Knows no clock: it is told how much time has passed.
class Arbitration {
 public:
  /// ramp: time in which the weight goes from 0 to 1 or back.
  explicit Arbitration(Duration ramp) : ramp_(ramp) {}

  /// in_reach: the object that is engaged, or any while none is, can be seen within reach.
  /// touching: some robot finger is stopped. elapsed: since the last step, 0 or more.
  void step(bool in_reach, bool touching, Duration elapsed);

  Phase phase() const { return phase_; }
  double weight() const { return weight_; }

 private:
  void handle(Event event);

  Duration ramp_;
  Phase phase_ = Phase::direct;
  double weight_ = 0;
};

}  // namespace prehend::mapping
