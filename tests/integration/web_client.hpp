#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace prehend::integration {

/// An HTTP request with these lines as its head, and all that is answered.
std::string ask(int port, const std::string& head, const std::string& body = "");

/// A WebSocket, as far as a test needs one: it answers pings while it is asked for messages.
class WebClient {
 public:
  struct Message {
    bool binary = false;
    std::string bytes;
    /// Of binary ones.
    std::uint32_t subscription() const;
    std::string_view payload() const { return std::string_view(bytes).substr(13); }
  };
  /// Opens it; `answer` is the head of what was answered.
  WebClient(int port, const std::string& protocols, const std::string& more_head = "",
            const std::string& target = "/");
  ~WebClient();
  WebClient(const WebClient&) = delete;
  WebClient& operator=(const WebClient&) = delete;

  bool open() const { return answer_.starts_with("HTTP/1.1 101 "); }
  const std::string& answer() const { return answer_; }
  void say(std::string_view text);
  void say_bytes(std::string_view bytes);
  /// Within the time; nothing when there is none, or the connection has ended.
  std::optional<Message> hear(double limit_s);
  /// Until one that is so.
  std::optional<Message> hear_until(double limit_s, const std::function<bool(const Message&)>& so);
  /// The other side has let it go.
  bool ended() const { return ended_; }

 private:
  bool fill(std::size_t size, double limit_s);

  int socket_ = -1;
  std::string answer_, received_;
  Message begun_;  // its first parts, when the time was over before the last one came
  bool ended_ = false;
};

}  // namespace prehend::integration
