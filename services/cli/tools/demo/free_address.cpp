#include "services/cli/tools/demo/free_address.hpp"

#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <random>

namespace prehend::cli {
namespace {

constexpr int first_of_domains = 7400, of_a_domain = 250, of_participants = 200;

bool is_free(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  const int handle = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (handle < 0) return true;  // who uses it will say why it cannot
  const bool bound =
      ::bind(handle, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  ::close(handle);
  return bound;
}

}  // namespace

std::string free_address() {
  std::random_device random;
  std::uniform_int_distribution<int> domain(50, 89);  // below the ports that the system gives out
  std::uniform_int_distribution<int> place(of_participants, of_a_domain - 1);
  while (true) {
    const int port = first_of_domains + of_a_domain * domain(random) + place(random);
    if (is_free(port)) return fmt::format("127.0.0.1:{}", port);
  }
}

}  // namespace prehend::cli
