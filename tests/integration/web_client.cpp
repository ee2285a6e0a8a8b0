#include "tests/integration/web_client.hpp"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <stdexcept>
#include <utility>

namespace prehend::integration {
namespace {

int connected(int port) {
  const int made = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(made, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    throw std::runtime_error("nobody listens");
  return made;
}

void send_all(int socket, std::string_view bytes) {
  while (!bytes.empty()) {
    const auto sent = ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) return;
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
}

/// Masked by nothing.
void send_frame(int socket, char head, std::string_view payload) {
  std::string frame(1, head);
  if (payload.size() < 126) {
    frame += static_cast<char>(0x80 | payload.size());
  } else {
    frame += static_cast<char>(0x80 | 126);
    frame += static_cast<char>(payload.size() >> 8);
    frame += static_cast<char>(payload.size() & 0xff);
  }
  send_all(socket, frame + std::string(4, '\0') + std::string(payload));
}

}  // namespace

std::string ask(int port, const std::string& head, const std::string& body) {
  const int socket = connected(port);
  send_all(socket, head + "\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body);
  std::string said(1 << 20, '\0');
  std::size_t size = 0;
  while (size < said.size()) {
    const auto got = ::recv(socket, said.data() + size, said.size() - size, 0);
    if (got <= 0) break;
    size += static_cast<std::size_t>(got);
  }
  ::close(socket);
  said.resize(size);
  return said;
}

std::uint32_t WebClient::Message::subscription() const {
  std::uint32_t id = 0;
  for (std::size_t i = 0; i < 4; ++i)
    id |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes.at(i + 1))) << (8 * i);
  return id;
}

WebClient::WebClient(int port, const std::string& protocols, const std::string& more_head,
                     const std::string& target)
    : socket_(connected(port)) {
  send_all(socket_, "GET " + target + " HTTP/1.1\r\nHost: localhost:" + std::to_string(port) +
                        "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: "
                        "13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
                        (protocols.empty() ? "" : "Sec-WebSocket-Protocol: " + protocols + "\r\n") +
                        more_head + "\r\n");
  while (answer_.find("\r\n\r\n") == std::string::npos && fill(1, 20)) {
    answer_ += received_.substr(0, 1);
    received_.erase(0, 1);
  }
}

WebClient::~WebClient() {
  ::close(socket_);
}

bool WebClient::fill(std::size_t size, double limit_s) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(limit_s);
  while (received_.size() < size) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
        end - std::chrono::steady_clock::now());
    pollfd wait{socket_, POLLIN, 0};
    if (left.count() < 0 || ::poll(&wait, 1, static_cast<int>(left.count())) <= 0) return false;
    char bytes[65536];
    const auto got = ::recv(socket_, bytes, sizeof bytes, 0);
    if (got <= 0) {
      ended_ = true;
      return false;
    }
    received_.append(bytes, static_cast<std::size_t>(got));
  }
  return true;
}

void WebClient::say(std::string_view text) {
  send_frame(socket_, '\x81', text);  // the whole of a text
}

void WebClient::say_bytes(std::string_view bytes) {
  send_frame(socket_, '\x82', bytes);  // the whole of a binary message
}

std::optional<WebClient::Message> WebClient::hear(double limit_s) {
  while (true) {
    if (!fill(2, limit_s)) return std::nullopt;
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(received_[i]); };
    const unsigned opcode = byte(0) & 15U;
    std::size_t size = byte(1) & 127U, head = 2;
    if (size >= 126) {
      const std::size_t bytes = size == 126 ? 2 : 8;
      if (!fill(head + bytes, limit_s)) return std::nullopt;
      size = 0;
      for (std::size_t i = 0; i < bytes; ++i) size = size << 8 | byte(head + i);
      head += bytes;
    }
    if (!fill(head + size, limit_s)) return std::nullopt;
    const bool last = (byte(0) & 128U) != 0;
    const std::string part = received_.substr(head, size);
    received_.erase(0, head + size);
    if (opcode == 8) ended_ = true;
    if (opcode == 9) send_frame(socket_, '\x8a', part);
    if (opcode > 2) continue;
    if (opcode == 2) begun_.binary = true;
    begun_.bytes += part;
    if (last) return std::exchange(begun_, {});
  }
}

std::optional<WebClient::Message> WebClient::hear_until(
    double limit_s, const std::function<bool(const Message&)>& so) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(limit_s);
  while (std::chrono::steady_clock::now() < end) {
    auto message =
        hear(std::chrono::duration<double>(end - std::chrono::steady_clock::now()).count());
    if (!message) return std::nullopt;
    if (so(*message)) return message;
  }
  return std::nullopt;
}

}  // namespace prehend::integration
