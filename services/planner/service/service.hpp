#pragma once

#include <memory>

#include "common/base/error.hpp"
#include "common/service/shell.hpp"

namespace prehend::planner {

/// The topics' side of the planner: detections in, grasps of the lab's hand out.
class Service {
 public:
  /// Fails when the hand or the catalogue cannot be used.
  static Expected<std::unique_ptr<Service>> create(service::Shell& shell);
  ~Service();

 private:
  class Topics;
  explicit Service(std::unique_ptr<Topics> topics);
  std::unique_ptr<Topics> topics_;
};

}  // namespace prehend::planner
