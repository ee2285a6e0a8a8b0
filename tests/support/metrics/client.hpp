#pragma once

#include <string>
#include <string_view>

namespace prehend::tests {

/// A TCP connection to a port of this host.
class Client {
 public:
  explicit Client(int port);
  ~Client();
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  bool connected() const { return connected_; }
  void say(std::string_view text) const;
  /// Says that nothing more will be said.
  void end() const;
  /// All that comes until the other side ends, or nothing more for half a minute.
  std::string hear() const;

 private:
  int socket_;
  bool connected_ = false;
};

}  // namespace prehend::tests
