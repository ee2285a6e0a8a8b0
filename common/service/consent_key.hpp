#pragma once

#include <string>

#include "common/base/time.hpp"
#include "common/service/shell.hpp"
#include "common/tool/held_key.hpp"
#include "idl/Operation.h"

namespace prehend::service {

/// Consent for one robot hand by a key that is held: where safety.deadman is asked for, it moves
/// only meanwhile. For programs of operators that have a terminal; they read its keys.
class ConsentKey {
 public:
  /// Between two ticks, at most.
  static constexpr Duration period = std::chrono::milliseconds(20);

  /// hand: key of its topics. The shell must outlive it.
  ConsentKey(Shell& shell, const std::string& hand);

  /// The space bar was pressed, or is repeated by the keyboard.
  void press(Time now) { key_.press(now); }
  /// Says whether it is held; `always`: whatever the key does.
  void tick(Time now, bool always = false);
  /// Lets go, whatever the key does. Before the shell ends.
  void end();

 private:
  void say(bool held, Time now);

  Shell& shell_;
  Shell::Output<v1::OperatorConsent> consents_;
  v1::OperatorConsent message_;
  tool::HeldKey key_;
  bool held_ = false;
};

}  // namespace prehend::service
