#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "common/web/site.hpp"

namespace prehend::web {

/// HTTP and WebSocket at one port, over TLS or not. A client costs a bounded number of bytes and,
/// until it has its answer, of seconds. There is a bounded number of them: who is silent or slow
/// gives way to who comes, but nobody takes the place of an open WebSocket.
class Server {
 public:
  struct Options {
    std::string address = "127.0.0.1";  // of this host, IPv4 or IPv6
    int port = 0;                       // 0: any that is free
    std::string certificate, key;       // texts, PEM; empty: without TLS
    std::size_t max_clients = 64;
    // With one client, from its coming until it has its answer; six times of it for a pong.
    Duration patience = std::chrono::seconds(10);
    // Of Site::tick(), when nothing is new; after wake() it comes as soon as what arrives together
    // is there, but not more often than `soonest`.
    Duration period = std::chrono::seconds(1);
    Duration together = std::chrono::milliseconds(2), soonest = std::chrono::microseconds(8333);
  };
  /// The site must outlive it.
  static Expected<std::unique_ptr<Server>> listen(const Options& options, Site& site);
  virtual ~Server() = default;

  virtual int port() const = 0;
  /// Who is connected now. For the thread that runs it.
  virtual std::size_t clients() const = 0;
  /// Serves for this time.
  virtual void run_for(Duration time) = 0;
  /// Serves until stop(), which every thread may call.
  virtual void run() = 0;
  virtual void stop() = 0;
  /// There is something new. Every thread may call it.
  virtual void wake() = 0;
};

}  // namespace prehend::web
