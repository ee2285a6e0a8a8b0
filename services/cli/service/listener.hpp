#pragma once

#include <memory>

#include "common/base/error.hpp"
#include "common/service/config.hpp"
#include "services/cli/service/observer.hpp"

namespace prehend::cli {

/// Takes part in a lab only to listen, and hands what it hears to an observer.
class Listener {
 public:
  /// everything: false listens to service/status alone.
  static Expected<Listener> create(const service::Config& config, bool everything);
  Listener(Listener&&) noexcept;
  Listener& operator=(Listener&&) noexcept;
  ~Listener();

  /// What has come since the last call.
  void poll(Observer& observer);

 private:
  struct State;
  explicit Listener(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace prehend::cli
