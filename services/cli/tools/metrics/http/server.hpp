#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "common/base/error.hpp"
#include "common/base/time.hpp"

namespace prehend::cli::http {

/// Serves one page over HTTP, in the thread that calls serve(). A client costs a bounded number of
/// bytes and of seconds, and there is a bounded number of them: who is silent or slow gives way to
/// who comes.
class Server {
 public:
  struct Options {
    std::string address = "127.0.0.1";            // of this host, IPv4 or IPv6
    int port = 0;                                 // 0: any that is free
    std::string path = "/metrics";                // of the page; all else is not found
    std::size_t max_clients = 32;                 // at once; who is silent gives way to who comes
    Duration patience = std::chrono::seconds(5);  // with one client, from its coming to its end
  };
  static Expected<Server> listen(const Options& options);
  Server(Server&&) noexcept;
  Server& operator=(Server&&) noexcept;
  ~Server();

  int port() const;
  /// Who is connected now.
  std::size_t clients() const;
  /// Answers who comes within this time. page() is called for each who asks for it.
  void serve(Duration time, const std::function<std::string()>& page);

 private:
  struct State;
  explicit Server(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace prehend::cli::http
