#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "services/console/core/access.hpp"
#include "services/console/core/hub.hpp"

namespace prehend::console::web {

struct Answer {
  int status = 200;
  std::string type;  // of its content
  std::string body;
  std::string cookie;  // to be kept by the browser; empty: none
};

/// What is served. Everything is called in the thread of Server::run().
class Site {
 public:
  virtual ~Site() = default;
  virtual Verdict judge(const Asked& asked) = 0;
  /// To anything but a WebSocket.
  virtual Answer answer(const Verdict& verdict, std::string_view body) = 0;
  virtual Hub& hub() = 0;
  /// Takes what is new; afterwards clients are sent what the hub has for them.
  virtual void tick() = 0;
};

/// HTTP and WebSocket at one port, over TLS or not. A client costs a bounded number of bytes, and
/// one that has not asked for anything yet a bounded number of seconds.
class Server {
 public:
  struct Options {
    /// Of this host, at which it listens.
    std::string address = "127.0.0.1";
    /// 0: any that is free.
    int port = 0;
    /// Texts, PEM; empty: without TLS.
    std::string certificate, key;
    /// At once; further ones are not let in.
    std::size_t max_clients = 64;
    /// Until a request is there; a client has six times of it for a pong.
    Duration patience = std::chrono::seconds(10);
    /// Between two calls of Site::tick() when nothing is new.
    Duration period = std::chrono::microseconds(16667);
    /// After wake() a tick comes so much later, so that what arrives together is there.
    Duration together = std::chrono::milliseconds(2);
    /// But it comes no sooner than this after the one before.
    Duration soonest = std::chrono::microseconds(8333);
  };
  /// The site must outlive it.
  static Expected<std::unique_ptr<Server>> listen(const Options& options, Site& site);
  virtual ~Server() = default;

  virtual int port() const = 0;
  /// Until stop(), which every thread may call.
  virtual void run() = 0;
  virtual void stop() = 0;
  /// There is something new. Every thread may call it.
  virtual void wake() = 0;
};

}  // namespace prehend::console::web
