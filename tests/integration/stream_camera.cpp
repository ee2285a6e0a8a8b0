#include "tests/integration/stream_camera.hpp"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <stdexcept>

#include "services/recognition/core/rendering/renderer.hpp"
#include "services/recognition/files/picture_file.hpp"

namespace prehend::integration {
namespace {

bool send_all(int guest, std::string_view bytes) {
  while (!bytes.empty()) {
    const auto sent = ::send(guest, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
  return true;
}

}  // namespace

StreamCamera::StreamCamera(double rate) : period_(1 / rate) {
  on();
}

StreamCamera::~StreamCamera() {
  off();
}

void StreamCamera::show(recognition::Picture still) {
  const std::lock_guard lock(mutex_);
  still_ = std::move(still);
}

void StreamCamera::on() {
  socket_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int yes = 1;
  ::setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port_));
  socklen_t size = sizeof address;
  if (::bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0 ||
      ::listen(socket_, 4) != 0 ||
      ::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size) != 0)
    throw std::runtime_error("no port for the camera");
  port_ = ntohs(address.sin_port);
  thread_ = std::jthread([this](const std::stop_token& stop) { serve(stop); });
}

void StreamCamera::off() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  if (socket_ >= 0) ::close(socket_);
  socket_ = -1;
}

bool StreamCamera::send(int guest, const recognition::Picture& picture) const {
  const auto jpeg = recognition::encode_jpeg(picture);
  const std::string head =
      "--frame\r\nContent-Type: image/jpeg\r\nContent-Length: " + std::to_string(jpeg.size()) +
      "\r\n\r\n";
  return send_all(guest, head) &&
         send_all(guest, {reinterpret_cast<const char*>(jpeg.data()), jpeg.size()}) &&
         send_all(guest, "\r\n");
}

void StreamCamera::serve(const std::stop_token& stop) {
  std::uint64_t noise = 0;
  while (!stop.stop_requested()) {
    pollfd waiting{socket_, POLLIN, 0};
    if (::poll(&waiting, 1, 50) <= 0) continue;
    const int guest = ::accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC);
    if (guest < 0) continue;
    char request[2048];
    bool there = ::read(guest, request, sizeof request) > 0 &&
                 send_all(guest,
                          "HTTP/1.0 200 OK\r\nContent-Type: multipart/x-mixed-replace; "
                          "boundary=frame\r\n\r\n");
    while (there && !stop.stop_requested()) {
      const auto due = std::chrono::steady_clock::now() + std::chrono::duration<double>(period_);
      recognition::Picture picture;
      {
        const std::lock_guard lock(mutex_);
        picture = still_;
      }
      recognition::Renderer::add_noise(picture, 2, ++noise);
      there = picture.empty() || send(guest, picture);
      std::this_thread::sleep_until(due);
    }
    ::close(guest);
  }
}

}  // namespace prehend::integration
