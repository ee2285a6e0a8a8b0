#pragma once

#include <memory>

#include "common/base/error.hpp"
#include "common/service/shell.hpp"

namespace prehend::demonstration {

/// The topics' side of demonstrations: postures, objects and orders in; grasps, phases and tasks
/// out. Moves nothing.
class Service {
 public:
  /// Fails when the recogniser, the taxonomy or the folder of tasks cannot be used.
  static Expected<std::unique_ptr<Service>> create(service::Shell& shell);
  ~Service();

 private:
  class Topics;
  explicit Service(std::unique_ptr<Topics> topics);
  std::unique_ptr<Topics> topics_;
};

}  // namespace prehend::demonstration
