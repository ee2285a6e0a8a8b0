// Malformed packets on the ports of discovery and data: packets of our own traffic, captured where
// the operator sits, each damaged in one to eight places, from a stranger on the same network. None
// of our processes may die of it, none need be started again, and the hand follows again within 1 s
// of the last packet. A crash inside the DDS library would be no fault that we can mend: it is
// reported with the packet, and whoever supervises the process starts it again (here the test
// does).
#include <arpa/inet.h>
#include <fmt/format.h>
#include <linux/if_packet.h>
#include <net/ethernet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <random>
#include <thread>

#include "tests/integration/fault_rig.hpp"

namespace prehend::integration {
namespace {

constexpr double flood_healed = 1.0;  // s, from the last packet

using Bytes = std::vector<std::uint8_t>;

struct Packet {
  std::uint16_t port = 0;
  Bytes payload;
};

/// RTPS packets that come and go at this thread's host.
class Capture {
 public:
  Capture() : socket_(::socket(AF_PACKET, SOCK_DGRAM | SOCK_NONBLOCK, htons(ETH_P_IP))) {}
  ~Capture() { ::close(socket_); }
  void take(std::vector<Packet>& packets) const {
    Bytes frame(65536);
    for (ssize_t n; (n = ::recv(socket_, frame.data(), frame.size(), 0)) > 0;) {
      const auto size = static_cast<std::size_t>(n);
      const std::size_t header = 4u * (frame[0] & 15u);
      constexpr std::size_t udp = 8;
      if (size < header + udp + 4 || frame[9] != IPPROTO_UDP) continue;
      const std::uint8_t* data = frame.data() + header;
      if (!std::equal(data + udp, data + udp + 4, "RTPS")) continue;
      packets.push_back({static_cast<std::uint16_t>(data[2] << 8 | data[3]),
                         Bytes(data + udp, static_cast<const std::uint8_t*>(frame.data()) + size)});
    }
  }

 private:
  int socket_;
};

Bytes damaged(const std::vector<Packet>& packets, std::mt19937& random) {
  const auto below = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  Bytes bytes = packets[below(packets.size())].payload;
  const std::size_t count = 1 + below(8);
  for (std::size_t i = 0; i < count && bytes.size() > 5; ++i) {
    // Mostly behind the word «RTPS», without which nobody reads on.
    const std::size_t at = 4 + below(bytes.size() - 4);
    switch (below(7)) {
      case 0:
        bytes[at] ^= static_cast<std::uint8_t>(1u << below(8));
        break;
      case 1:
        bytes[at] = static_cast<std::uint8_t>(below(256));
        break;
      case 2:  // an extreme length or number
        for (std::size_t j = at; j < std::min(at + 4, bytes.size()); ++j)
          bytes[j] = below(2) ? 0xff : 0x7f;
        break;
      case 3:
        std::fill_n(bytes.begin() + static_cast<long>(at),
                    std::min<std::size_t>(4, bytes.size() - at), std::uint8_t{0});
        break;
      case 4:
        bytes.resize(at);
        break;
      case 5:
        bytes.insert(bytes.begin() + static_cast<long>(at), 1 + below(16),
                     static_cast<std::uint8_t>(below(256)));
        break;
      default: {  // the tail of another packet
        const Bytes& other = packets[below(packets.size())].payload;
        bytes.resize(at);
        bytes.insert(bytes.end(), other.begin() + static_cast<long>(below(other.size())),
                     other.end());
      }
    }
  }
  if (bytes.size() > 1472) bytes.resize(1472);
  return bytes;
}

class Flood : public FaultRig {
 protected:
  void SetUp() override {
    FaultRig::SetUp();
    if (!hosts_) return;
    for (const char* host : {"hand", "eye", "robot", "stranger"}) hosts_->add(host);
    // The operator is this process, which shall tell what became of the others.
    hosts_->refuse("operator", "stranger");
    start_lab();
  }
  void flood(const std::string& fault);
};

void Flood::flood(const std::string& fault) {
  FaultRow row;
  row.fault = fault;
  row.rounds = rounds(500, 10'000);
  std::vector<Packet> packets;
  const Capture capture;
  // Beginnings, too: who joins now is greeted by all.
  auto newcomer = launch("glove", {}, {"lab.rig=elsewhere"}, "newcomer");
  operate(3, [&] {
    capture.take(packets);
    return false;
  });
  newcomer.stop(seconds(5));
  ASSERT_GT(packets.size(), 100u);
  row.memory_before = memory();

  int out = -1;
  std::thread([&] {
    hosts_->enter_for_good("stranger");
    out = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  }).join();
  ASSERT_GE(out, 0);
  std::mt19937 random{11};
  const auto base = static_cast<std::uint16_t>(7400 + 250 * domain_);
  std::vector<std::pair<std::string, std::uint16_t>> targets{{"239.255.0.1", base}};
  for (const char* host : {"hand", "eye", "robot"})
    for (int port = 10; port < 14; ++port)
      targets.emplace_back(hosts_->address(host), static_cast<std::uint16_t>(base + port));
  int crashes = 0;
  for (int i = 0; i < row.rounds; ++i) {
    const Bytes bytes = damaged(packets, random);
    for (const auto& [address, port] : targets) {
      sockaddr_in to{};
      to.sin_family = AF_INET;
      to.sin_port = htons(port);
      ::inet_pton(AF_INET, address.c_str(), &to.sin_addr);
      ::sendto(out, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&to), sizeof(to));
    }
    operate(0.002);
    Strings dead;
    for (auto& [name, process] : processes_) {
      const auto exit = process.exit();
      if (!exit) continue;
      dead.push_back(name);
      std::cout << name << " ended by signal " << exit->signal << ", code " << exit->code
                << ", after packet " << i << ": " << stage::last_lines(process.log(), 1)
                << std::endl;
    }
    if (dead.empty()) continue;
    crashes += static_cast<int>(dead.size());
    for (const std::uint8_t byte : bytes) fmt::print("{:02x}", byte);
    std::cout << std::endl;
    const std::int64_t start = now_ns();
    for (const std::string& name : dead) processes_.insert_or_assign(name, launch(name));
    row.recoveries.push_back(recovery(start));
    EXPECT_GT(row.recoveries.back(), 0);
    EXPECT_LT(row.recoveries.back(), promised(2));
  }
  ::close(out);
  expect_recovery(row, flood_healed);  // otherwise a damaged packet was believed
  std::cout << row.rounds << " packets to " << targets.size() << " ports each, " << crashes
            << " crashes\n";
  EXPECT_EQ(crashes, 0);
  finish(std::move(row));
}

TEST_F(Flood, MalformedPackets) {
  flood("malformed packets");
}

class SecuredFlood : public Flood {
 protected:
  void SetUp() override {
    secure();
    Flood::SetUp();
  }
};

TEST_F(SecuredFlood, MalformedPackets) {
  flood("malformed packets, with keys");
}

}  // namespace
}  // namespace prehend::integration
