#pragma once

#include <optional>
#include <string>

#include "common/dds/topics.hpp"
#include "common/service/consent_key.hpp"
#include "common/service/shell.hpp"
#include "common/tool/keyboard.hpp"
#include "services/mapping/tools/training/teach.hpp"

namespace prehend::mapping {

/// A session with a glove: prompts, takes, and tells the lab what was shown. Ends its shell when
/// all is shown, after the limit, or when a person gives up.
class TeachSession {
 public:
  /// Shell and teacher must outlive it. `consents`: the space bar is the deadman of the lab's hand.
  TeachSession(service::Shell& shell, Teacher& teacher, Duration limit, bool consents);

 private:
  void prompt();
  void see(const v1::HandPosture& message);
  void tell(const Shown& shown, Time stamp);
  void hint();
  void tick(Time now);
  void on_key(int key, Time now);

  service::Shell& shell_;
  Teacher& teacher_;
  Time begun_;
  Duration limit_;
  service::Shell::Output<v1::OperatorCommand> orders_;
  int told_ = 0;
  std::string reason_;  // why nothing is taken, since when, and whether it was said
  Time since_{};
  bool hinted_ = false;
  bool closed_ = false;  // standard input
  std::optional<tool::Keyboard> keyboard_;
  std::optional<service::ConsentKey> consent_;
};

}  // namespace prehend::mapping
