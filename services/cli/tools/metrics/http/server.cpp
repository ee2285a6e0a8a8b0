#include "services/cli/tools/metrics/http/server.hpp"

#include <fmt/format.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <deque>
#include <utility>
#include <vector>

#include "services/cli/tools/metrics/http/request.hpp"

namespace prehend::cli::http {
namespace {

using Clock = std::chrono::steady_clock;

/// Time and bytes that are waited for and thrown away after the answer: a socket that is closed
/// with something unread takes the answer with it.
constexpr auto farewell = std::chrono::seconds(1);
constexpr std::size_t max_thrown_away = 65536;

class Socket {
 public:
  explicit Socket(int handle) : handle_(handle) {}
  Socket(Socket&& other) noexcept : handle_(std::exchange(other.handle_, -1)) {}
  Socket& operator=(Socket&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~Socket() {
    if (handle_ >= 0) ::close(handle_);
  }
  int handle() const { return handle_; }

 private:
  int handle_;
};

struct Client {
  Socket socket;
  Clock::time_point end;
  std::string received = {};
  std::string reply = {};       // empty: the request has not come to its end
  std::size_t sent = 0;         // of the reply
  std::size_t thrown_away = 0;  // after it
  bool over = false;

  bool reading() const { return reply.empty(); }
  bool leaving() const { return !reading() && sent == reply.size(); }
};

}  // namespace

struct Server::State {
  Options options;
  Socket listener;
  int port = 0;
  std::deque<Client> clients = {};  // in the order in which they came

  /// False: this process may open no more.
  bool accept_some(const std::function<std::string()>& page);
  void make_room();
  void read(Client& client, const std::function<std::string()>& page);
  void write(Client& client);
  static void leave(Client& client);
};

/// Who has not said what it wants goes first.
void Server::State::make_room() {
  if (clients.empty()) return;
  const auto idle = std::find_if(clients.begin(), clients.end(),
                                 [](const Client& client) { return client.reading(); });
  clients.erase(idle != clients.end() ? idle : clients.begin());
}

bool Server::State::accept_some(const std::function<std::string()>& page) {
  for (std::size_t i = 0; i < options.max_clients; ++i) {
    const int handle = ::accept4(listener.handle(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (handle < 0) {
      if (errno == EAGAIN || errno == EINTR || errno == ECONNABORTED) return true;
      make_room();
      return false;
    }
    if (clients.size() >= options.max_clients) make_room();
    clients.push_back({Socket(handle), Clock::now() + options.patience});
    // Before anybody can push it out: mostly it has said what it wants.
    read(clients.back(), page);
  }
  return true;
}

void Server::State::read(Client& client, const std::function<std::string()>& page) {
  std::array<char, 2048> bytes;
  const std::size_t room = max_request + 1 - client.received.size();
  const ssize_t size =
      ::recv(client.socket.handle(), bytes.data(), std::min(room, bytes.size()), 0);
  if (size <= 0) {
    client.over = size == 0 || (errno != EAGAIN && errno != EINTR);
    return;
  }
  client.received.append(bytes.data(), static_cast<std::size_t>(size));
  const Verdict verdict = judge(client.received, options.path);
  if (verdict.status == 0) return;
  client.reply = response(verdict, verdict.status == 200 ? page() : std::string());
  write(client);
}

void Server::State::write(Client& client) {
  const ssize_t size = ::send(client.socket.handle(), client.reply.data() + client.sent,
                              client.reply.size() - client.sent, MSG_NOSIGNAL);
  if (size < 0) {
    client.over = errno != EAGAIN && errno != EINTR;
    return;
  }
  client.sent += static_cast<std::size_t>(size);
  if (!client.leaving()) return;
  ::shutdown(client.socket.handle(), SHUT_WR);
  client.end = std::min(client.end, Clock::now() + farewell);
}

void Server::State::leave(Client& client) {
  std::array<char, 2048> bytes;
  const ssize_t size = ::recv(client.socket.handle(), bytes.data(), bytes.size(), 0);
  if (size > 0) client.thrown_away += static_cast<std::size_t>(size);
  client.over = size == 0 || (size < 0 && errno != EAGAIN && errno != EINTR) ||
                client.thrown_away > max_thrown_away;
}

Server::Server(std::unique_ptr<State> state) : state_(std::move(state)) {}
Server::Server(Server&&) noexcept = default;
Server& Server::operator=(Server&&) noexcept = default;
Server::~Server() = default;

Expected<Server> Server::listen(const Options& options) {
  const std::string where = fmt::format("{} port {}", options.address, options.port);
  addrinfo hints{};
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV | AI_PASSIVE;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* list = nullptr;
  if (const int code = ::getaddrinfo(options.address.c_str(), std::to_string(options.port).c_str(),
                                     &hints, &list);
      code != 0)
    return wrong_use(::gai_strerror(code), where, "an address of this host, as 127.0.0.1");
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> found(list, &::freeaddrinfo);
  Socket socket(::socket(found->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const int on = 1;
  // A server that is started anew does not wait until the last connections are forgotten.
  if (socket.handle() < 0 ||
      ::setsockopt(socket.handle(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) != 0 ||
      ::bind(socket.handle(), found->ai_addr, found->ai_addrlen) != 0 ||
      ::listen(socket.handle(), SOMAXCONN) != 0)
    return fail(std::strerror(errno), where, "does another one serve there?");
  sockaddr_storage bound{};
  socklen_t length = sizeof bound;
  std::array<char, 8> port{};
  if (::getsockname(socket.handle(), reinterpret_cast<sockaddr*>(&bound), &length) != 0 ||
      ::getnameinfo(reinterpret_cast<sockaddr*>(&bound), length, nullptr, 0, port.data(),
                    port.size(), NI_NUMERICSERV) != 0)
    return fail("its port is not known", where);
  return Server(std::make_unique<State>(State{options, std::move(socket), std::atoi(port.data())}));
}

int Server::port() const {
  return state_->port;
}
std::size_t Server::clients() const {
  return state_->clients.size();
}

void Server::serve(Duration time, const std::function<std::string()>& page) {
  State& state = *state_;
  const auto end = Clock::now() + time;
  bool accepts = true;
  for (auto now = Clock::now(); now < end; now = Clock::now()) {
    auto until = end;
    std::vector<pollfd> watched{
        {state.listener.handle(), static_cast<short>(accepts ? POLLIN : 0), 0}};
    for (const Client& client : state.clients) {
      const bool writes = !client.reading() && !client.leaving();
      watched.push_back({client.socket.handle(), static_cast<short>(writes ? POLLOUT : POLLIN), 0});
      until = std::min(until, client.end);
    }
    const auto wait = std::chrono::ceil<std::chrono::milliseconds>(std::max(until, now) - now);
    if (::poll(watched.data(), watched.size(), static_cast<int>(wait.count())) < 0) return;
    for (std::size_t i = 1; i < watched.size(); ++i) {
      Client& client = state.clients[i - 1];
      if (client.end <= Clock::now()) client.over = true;
      if (client.over || watched[i].revents == 0) continue;
      if (client.reading())
        state.read(client, page);
      else if (client.leaving())
        State::leave(client);
      else
        state.write(client);
    }
    std::erase_if(state.clients, [](const Client& client) { return client.over; });
    if (watched[0].revents != 0) accepts = state.accept_some(page);
  }
}

}  // namespace prehend::cli::http
