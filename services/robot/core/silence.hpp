#pragma once

#include <string>

#include "common/base/time.hpp"

namespace prehend::robot {

/// For how long nothing sound has been heard, and for how long of that was listened. A program that
/// was held up has not listened meanwhile, and what it asked may have been held up with it: between
/// two looks little counts.
class Silence {
 public:
  void end(Time now);
  void listen(Time now);

  /// When something sound was heard last.
  Time began() const { return began_; }
  Duration listened() const { return listened_; }
  /// Whose fault it is.
  std::string words(Time now) const;

 private:
  Time began_{}, looked_{};
  Duration listened_{};
};

}  // namespace prehend::robot
