#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace prehend::web {

using Fields = std::vector<std::pair<std::string, std::string>>;

/// What somebody asks for. Its head is sound HTTP/1.1 [RFC9112] and within the server's limits.
struct Request {
  std::string method, target, body;
  bool upgrade = false;  // to a WebSocket
  Fields fields;

  /// What stands in all fields of this name, with commas between them; empty: there is none.
  std::string field(std::string_view name) const;
};

struct Answer {
  int status = 200;
  std::string type;  // of its content
  std::string body;
  Fields fields = {};  // beside those that every answer has
};

/// An answer of one line.
Answer plain(int status, std::string line);

/// One message of a WebSocket.
struct Frame {
  bool binary = false;
  std::string head;                            // the receiver's own bytes
  std::shared_ptr<const std::string> payload;  // behind them; may be nothing
};

/// The site's side of one WebSocket. It is destroyed when the WebSocket has ended.
class Channel {
 public:
  virtual ~Channel() = default;
  virtual void hear(std::string_view said, bool binary) = 0;
  /// What is to be sent; nothing: all has been sent.
  virtual std::optional<Frame> next() = 0;
  /// The other side does not take what it asked for, so it is to be let go.
  virtual bool overflowed() const = 0;
};

/// A request becomes a WebSocket.
struct Upgrade {
  std::string protocol;
  std::unique_ptr<Channel> channel;
};

/// What is served. Everything is called in the thread that runs the server.
class Site {
 public:
  virtual ~Site() = default;
  virtual std::variant<Answer, Upgrade> answer(const Request& request) = 0;
  /// Takes what is new. Afterwards each WebSocket is sent what its channel has.
  virtual void tick() {}
};

}  // namespace prehend::web
