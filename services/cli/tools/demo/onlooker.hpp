#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include "common/model/scene.hpp"
#include "common/service/config.hpp"
#include "common/service/lab.hpp"
#include "services/cli/service/listener.hpp"
#include "services/cli/service/observer.hpp"
#include "services/cli/tools/demo/options.hpp"

namespace prehend::cli {

/// Looks at a lab while something is awaited, and says how it goes. Trouble: a process died, or
/// somebody pressed Ctrl-C.
class Onlooker {
 public:
  /// patience: s, from now on, for all that is awaited.
  Onlooker(const Progress& progress, double patience);

  /// Hears the lab of this configuration from now on. truth: what stands on the table, where that
  /// is known.
  Trouble listen(const service::Config& config, const std::optional<model::Scene>& truth);
  /// These processes must live, but one that may end with success; empty: none may. They must
  /// outlive it.
  void mind(service::Lab& lab, const std::string& may_end);

  /// Listens a moment.
  Trouble step(const std::string& what);
  /// Until it is there; `late` is what is wrong when it never comes.
  Trouble await(const std::string& what, const std::function<bool()>& is_there,
                const std::function<Error()>& late);
  bool is_late() const { return std::chrono::steady_clock::now() >= end_; }

  const Observer& seen() const { return observer_; }

 private:
  Trouble expect_arm(const service::Config& config);

  const Progress& progress_;
  std::chrono::steady_clock::time_point end_;
  Observer observer_;
  std::optional<Listener> listener_;
  service::Lab* lab_ = nullptr;
  std::string may_end_;
};

}  // namespace prehend::cli
