// The demonstration once sent its hand to a port that a participant of another lab had: the glove
// said «no glove frame within 45 s».
#include "services/cli/tools/demo/free_address.hpp"

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <set>
#include <vector>

namespace prehend::cli {
namespace {

int port_of(const std::string& address) {
  EXPECT_TRUE(address.starts_with("127.0.0.1:")) << address;
  return std::stoi(address.substr(address.find(':') + 1));
}

TEST(FreeAddress, IsNoneOfAParticipant) {
  std::set<int> seen;
  for (int i = 0; i < 300; ++i) {
    const int port = port_of(free_address());
    // Number n of a domain has 10 + 2n and 11 + 2n beyond its first: ninety have room below 200.
    EXPECT_GE((port - 7400) % 250, 200) << port;
    EXPECT_LT(port, 32768) << "the system gives it to anybody";
    seen.insert(port);
  }
  EXPECT_GT(seen.size(), 100u) << "two labs at once would often have the same";
}

TEST(FreeAddress, IsNobodys) {
  // Of some 2,000 ports 300 are taken, one after the other: chance would meet one that is.
  std::vector<int> sockets;
  for (int i = 0; i < 300; ++i) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(port_of(free_address())));
    sockets.push_back(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    EXPECT_EQ(::bind(sockets.back(), reinterpret_cast<const sockaddr*>(&address), sizeof address),
              0);
  }
  for (const int socket : sockets) ::close(socket);
}

}  // namespace
}  // namespace prehend::cli
