#pragma once

#include <memory>

#include "common/base/error.hpp"
#include "common/service/shell.hpp"
#include "services/tally/core/tally.hpp"

namespace prehend::tally {

/// The topic's side of the tally.
class Service {
 public:
  static Expected<std::unique_ptr<Service>> create(service::Shell& shell);

 private:
  explicit Service(service::Shell& shell);

  Tally tally_;
};

}  // namespace prehend::tally
