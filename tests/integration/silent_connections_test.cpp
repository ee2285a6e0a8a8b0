// A site that listens by TCP with keys (lab.network = wan), and connections to it that say nothing,
// or begin a handshake of TLS and stop: they keep nobody out for long who has keys. Fast DDS, 2.9.1
// as 3.1.2, makes one handshake at a time and waits for its end without a limit. The sites are
// hosts that are network spaces, with no UDP between them.
#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <openssl/ssl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <memory>

#include "tests/integration/hosts.hpp"
#include "tests/integration/rig.hpp"

namespace prehend::integration {
namespace {

constexpr std::uint16_t port = 7420;  // the first of a site

/// The first words of one who makes a connection of TLS.
std::string client_hello() {
  const std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)> context(SSL_CTX_new(TLS_client_method()),
                                                                  SSL_CTX_free);
  const std::unique_ptr<SSL, decltype(&SSL_free)> client(SSL_new(context.get()), SSL_free);
  BIO* said = BIO_new(BIO_s_mem());
  SSL_set_bio(client.get(), BIO_new(BIO_s_mem()), said);
  SSL_connect(client.get());
  std::string bytes(4096, '\0');
  const int size = BIO_read(said, bytes.data(), static_cast<int>(bytes.size()));
  bytes.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  return bytes;
}

/// A connection that is held open; its end is seen by is_open().
class Connection {
 public:
  explicit Connection(const std::string& address) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    ::inet_pton(AF_INET, address.c_str(), &to.sin_addr);
    connected_ = ::connect(socket_, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0;
  }
  Connection(Connection&& other) noexcept
      : socket_(std::exchange(other.socket_, -1)), connected_(other.connected_) {}
  ~Connection() {
    if (socket_ >= 0) ::close(socket_);
  }
  bool connected() const { return connected_; }
  void say(const std::string& bytes) const {
    EXPECT_EQ(::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(bytes.size()));
  }
  bool is_open() const {
    char byte = 0;
    const ssize_t size = ::recv(socket_, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
    return size > 0 || (size < 0 && errno == EAGAIN);
  }

 private:
  int socket_;
  bool connected_ = false;
};

class SilentConnections : public Rig {
 protected:
  void SetUp() override {
    if (const auto why = Hosts::unavailable()) GTEST_SKIP() << *why;
    const std::string keys = (folder_ / "keys").string();
    ASSERT_EQ(run("prehend", with_lab({"keys", "init", keys}), 20).exit_code, 0);
    network_ = {.profile = "wan", .keys = keys};
    hosts_.emplace();
    hosts_->add("robot");
    hosts_->add("glove");
    for (const auto& [host, other] : {std::pair("robot", "glove"), std::pair("glove", "robot")})
      ASSERT_EQ(ended(*hosts_, host,
                      {"iptables", "-A", "INPUT", "-p", "udp", "-s", hosts_->address(other), "-j",
                       "DROP"},
                      10),
                0);
    Strings command = with_lab({program("prehend-simulation")});
    auto made = service::Process::start(
        {.command = hosts_->on("robot", command), .log = folder_ / "simulation.log"});
    ASSERT_TRUE(made);
    simulation_.emplace(std::move(*made));
    hosts_->enter("glove");
    ASSERT_TRUE(eventually(20, [&] { return Connection(hosts_->address("robot")).connected(); }));
  }

  /// Holds connections that say these bytes, while somebody with keys looks for the simulation.
  void hold(int count, const std::string& bytes, double limit_s) {
    std::vector<Connection> held;
    for (int i = 0; i < count; ++i) {
      held.emplace_back(hosts_->address("robot"));
      ASSERT_TRUE(held.back().connected()) << i;
      if (!bytes.empty()) held.back().say(bytes);
    }
    const auto start = std::chrono::steady_clock::now();
    Strings command = with_lab({program("prehend"), "status", "--wait", "simulation", "--timeout",
                                fmt::format("{}", limit_s)});
    command.insert(command.end(),
                   {"--set", fmt::format("lab.peers=[\"{}\"]", hosts_->address("robot"))});
    const int code = ended(*hosts_, "glove", command, limit_s + 10);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    const auto open = std::ranges::count_if(held, &Connection::is_open);
    fmt::print("{} connections that say {} bytes, {} of them still open: {} after {:.2f} s\n",
               count, bytes.size(), open, code == 0 ? "found" : "not found", took.count());
    EXPECT_EQ(code, 0);
    EXPECT_FALSE(simulation_->exit());
  }

  /// A hundred are gone after 25 s.
  static int many() { return std::getenv("PREHEND_LONG") ? 100 : 8; }
  int ended(const Hosts& hosts, const std::string& host, const Strings& command, double limit_s) {
    auto made = service::Process::start(
        {.command = hosts.on(host, command), .log = folder_ / (host + ".log")});
    if (!made) return -1;
    const auto exit = made->wait(seconds(limit_s));
    made->stop(seconds(5));
    return exit ? exit->code : -1;
  }

  std::optional<Hosts> hosts_;
  std::optional<service::Process> simulation_;
};

TEST_F(SilentConnections, KeepNobodyOutForLong) {
  hold(0, "", 10);
  hold(1, "", 15);
  hold(many(), "", 60);
}

TEST_F(SilentConnections, ThatStopInTheirHandshakeKeepNobodyOutForLong) {
  const std::string hello = client_hello();
  ASSERT_GT(hello.size(), 100u);
  hold(1, hello, 15);
  hold(many(), hello, 60);
}

}  // namespace
}  // namespace prehend::integration
