#pragma once

#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "common/service/config.hpp"

/// A process answers for itself, on a local socket: who asks whether it is alive needs no DDS, no
/// discovery and no keys, so that nothing else can make a living process seem dead.
namespace prehend::service {

/// Where the service of this name answers: a name that goes when the process does. It is seen in
/// the same network name space alone, as in one container. Of several gloves, mappings or robots in
/// one lab each has its own, by its name in the configuration.
std::string pulse_name(const Config& config, const std::string& service);

/// Answers in the thread of run(): a process whose loop hangs does not.
class Pulse {
 public:
  /// Runs a task in that thread.
  using Post = std::function<void(std::function<void()> task)>;
  /// Fails when another process answers there.
  static Expected<std::unique_ptr<Pulse>> create(const std::string& name, Post post);
  ~Pulse();
  Pulse(const Pulse&) = delete;
  Pulse& operator=(const Pulse&) = delete;

 private:
  Pulse(int socket, Post post);
  void listen();

  int socket_;
  Post post_;
  std::jthread thread_;  // last: uses the rest
};

/// Succeeds when the process answers in time. Only one of the same user, or of root, is believed.
Expected<void> ask_pulse(const std::string& name, Duration timeout);

}  // namespace prehend::service
