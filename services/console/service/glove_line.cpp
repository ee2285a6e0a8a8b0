#include "services/console/service/glove_line.hpp"

#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "common/base/file_text.hpp"

namespace prehend::console {
namespace {

constexpr std::string_view device = "landmarks", usual_port = "127.0.0.1:9870";

/// A socket that sends there, or -1.
int connected_to(const std::string& host, const std::string& port) {
  addrinfo wanted{}, *found = nullptr;
  wanted.ai_family = AF_INET;
  wanted.ai_socktype = SOCK_DGRAM;
  if (::getaddrinfo(host.c_str(), port.c_str(), &wanted, &found) != 0) return -1;
  const int made = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const bool good = made >= 0 && ::connect(made, found->ai_addr, found->ai_addrlen) == 0;
  ::freeaddrinfo(found);
  if (good || made < 0) return made;
  ::close(made);
  return -1;
}

}  // namespace

Expected<std::unique_ptr<GloveLine>> GloveLine::create(const service::Config& config) {
  const std::string& kind = config.text("glove.device");
  if (kind != device)
    return fail("is no glove that a page can be", "glove.device = " + kind,
                "set glove.device = landmarks");
  std::string token;
  if (const auto file = config.path("glove.token_file"); !file.empty()) {
    const auto text = read_file(file, "see glove.token_file");
    if (!text) return tl::unexpected(text.error());
    token = text->substr(0, text->find_first_of("\r\n")) + "\n";
  }
  std::string to = config.text("glove.port");
  if (to.empty()) to = usual_port;
  const std::size_t colon = to.rfind(':');
  const int socket =
      colon == std::string::npos ? -1 : connected_to(to.substr(0, colon), to.substr(colon + 1));
  if (socket < 0) return fail("cannot be sent to", "glove.port = " + to, "give HOST:PORT");
  return std::unique_ptr<GloveLine>(new GloveLine(socket, std::move(token)));
}

GloveLine::~GloveLine() {
  ::close(socket_);
}

void GloveLine::send(std::string_view line) const {
  const std::string whole = token_ + std::string(line) + "\n";
  (void)::send(socket_, whole.data(), whole.size(), 0);
}

}  // namespace prehend::console
