#pragma once

#include <memory>

#include "common/base/error.hpp"
#include "common/service/shell.hpp"

namespace prehend::mapping {

/// Obeys ACTION_TEACH: asks a person for postures as `prehend teach` does, trains as `prehend
/// train` does, and tells on mapping/training how far it is. It trains in a thread of its own, and
/// with one core, so that the lab beside it keeps its pace.
class Lessons {
 public:
  /// Fails where hand or scheme cannot be used.
  static Expected<std::unique_ptr<Lessons>> create(service::Shell& shell);
  ~Lessons();

 private:
  class Topics;
  explicit Lessons(std::unique_ptr<Topics> topics);
  std::unique_ptr<Topics> topics_;
};

}  // namespace prehend::mapping
