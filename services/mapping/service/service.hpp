#pragma once

#include <memory>

#include "common/base/error.hpp"
#include "common/service/shell.hpp"

namespace prehend::mapping {

/// The topics' side of the mapping: postures, detections, states and orders in, commands out.
class Service {
 public:
  /// Fails when hand, model or mode cannot be used.
  static Expected<std::unique_ptr<Service>> create(service::Shell& shell);
  ~Service();

 private:
  struct Known;
  class Topics;
  explicit Service(std::unique_ptr<Topics> topics);
  std::unique_ptr<Topics> topics_;
};

}  // namespace prehend::mapping
