#include "common/dds/guard/tls_front.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <linux/tcp.h>
#include <netinet/in.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <poll.h>
#include <signal.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <list>
#include <thread>
#include <utility>
#include <vector>

#include "common/base/file_text.hpp"
#include "common/keys/openssl.hpp"

namespace prehend::dds::tls {

using Clock = std::chrono::steady_clock;
using Context = keys::openssl::Owned<SSL_CTX, SSL_CTX_free>;
using Ssl = keys::openssl::Owned<SSL, SSL_free>;

inline constexpr std::chrono::milliseconds handshake_time{2000};  // until both handshakes are done
inline constexpr std::size_t max_waiting = 256;  // who shake hands; the oldest goes
inline constexpr std::size_t max_open = 512;
inline constexpr int max_parts = 16;  // that one connection passes on before others have their turn

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

inline sockaddr_in address(std::uint32_t ip, std::uint16_t port) {
  sockaddr_in made{};
  made.sin_family = AF_INET;
  made.sin_addr.s_addr = htonl(ip);
  made.sin_port = htons(port);
  return made;
}

inline Socket tcp_socket() {
  return Socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
}

/// For both sides: with the keys of this process, for peers with keys of the lab.
inline Expected<Context> context_of(const TlsFront::Options& files) {
  const auto text = read_file(files.revoked);
  if (!text) return tl::unexpected(text.error());
  const auto revoked = keys::openssl::list_of(*text);
  if (!revoked) return tl::unexpected(revoked.error());
  Context made(SSL_CTX_new(TLS_method()));
  SSL_CTX* raw = made.get();
  const bool good = raw && SSL_CTX_set_min_proto_version(raw, TLS1_2_VERSION) == 1 &&
                    SSL_CTX_use_certificate_chain_file(raw, files.certificate.c_str()) == 1 &&
                    SSL_CTX_use_PrivateKey_file(raw, files.key.c_str(), SSL_FILETYPE_PEM) == 1 &&
                    SSL_CTX_load_verify_locations(raw, files.authority.c_str(), nullptr) == 1 &&
                    X509_STORE_add_crl(SSL_CTX_get_cert_store(raw), revoked->get()) == 1 &&
                    X509_STORE_set_flags(SSL_CTX_get_cert_store(raw), X509_V_FLAG_CRL_CHECK) == 1 &&
                    SSL_CTX_set_num_tickets(raw, 0) == 1;
  if (!good)
    return keys::openssl::failed("cannot be used for TLS",
                                 files.certificate.parent_path().string());
  SSL_CTX_set_verify(raw, SSL_VERIFY_PEER | SSL_VERIFY_FAIL_IF_NO_PEER_CERT, nullptr);
  SSL_CTX_set_session_cache_mode(raw, SSL_SESS_CACHE_OFF);
  SSL_CTX_set_options(raw, SSL_OP_NO_RENEGOTIATION);
  SSL_CTX_set_mode(raw, SSL_MODE_ENABLE_PARTIAL_WRITE | SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER);
  return made;
}

/// One end of a connection. What it waits for is kept for poll().
class Side {
 public:
  Side(Socket socket, SSL_CTX* context) : socket_(std::move(socket)), ssl_(SSL_new(context)) {
    const int on = 1;
    ::setsockopt(socket_.handle(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    if (!ssl_ || SSL_set_fd(ssl_.get(), socket_.handle()) != 1) ended_ = true;
  }
  void accept() { SSL_set_accept_state(ssl_.get()); }
  void connect() { SSL_set_connect_state(ssl_.get()); }

  bool shake() { return shaken_ = shaken_ || done(SSL_do_handshake(ssl_.get())); }
  /// How many bytes came; 0: none yet.
  std::size_t read(char* to, std::size_t most) {
    const int got = SSL_read(ssl_.get(), to, static_cast<int>(most));
    return done(got) ? static_cast<std::size_t>(got) : 0;
  }
  std::size_t write(const char* from, std::size_t size) {
    const int put = SSL_write(ssl_.get(), from, static_cast<int>(size));
    return done(put) ? static_cast<std::size_t>(put) : 0;
  }
  bool is_shaken() const { return shaken_; }
  bool has_ended() const { return ended_; }

  void forget_waits() { events_ = 0; }
  /// Who waits for nothing is passed over: poll() would tell of a socket that is not connected yet.
  pollfd waits() const { return {events_ == 0 ? -1 : socket_.handle(), events_, 0}; }
  int handle() const { return socket_.handle(); }

 private:
  bool done(int result) {
    if (result > 0) return true;
    switch (SSL_get_error(ssl_.get(), result)) {
      case SSL_ERROR_WANT_READ:
        events_ |= POLLIN;
        break;
      case SSL_ERROR_WANT_WRITE:
        events_ |= POLLOUT;
        break;
      default:
        ended_ = true;
    }
    ERR_clear_error();
    return false;
  }

  Socket socket_;
  Ssl ssl_;
  short events_ = 0;
  bool shaken_ = false, ended_ = false;
};

/// What goes one way.
class Way {
 public:
  /// True: there may be more.
  bool pass(Side& from, Side& to) {
    for (int i = 0; i < max_parts; ++i) {
      if (begin_ == end_) {
        begin_ = 0;
        end_ = from.read(bytes_.data(), bytes_.size());
        if (end_ == 0) return false;
      }
      const std::size_t written = to.write(bytes_.data() + begin_, end_ - begin_);
      if (written == 0) return false;
      begin_ += written;
    }
    return true;
  }

 private:
  std::array<char, 16384> bytes_;
  std::size_t begin_ = 0, end_ = 0;
};

class Connection {
 public:
  Connection(Socket outer, SSL_CTX* context, std::uint16_t inner_port)
      : outer_(std::move(outer), context), inner_(tcp_socket(), context) {
    outer_.accept();
    inner_.connect();
    inner_at_ = address(INADDR_LOOPBACK, inner_port);
  }
  /// As far as it can.
  void go_on() {
    outer_.forget_waits();
    inner_.forget_waits();
    has_more_ = false;
    if (!outer_.shake() || !call() || !inner_.shake()) return;
    const bool in = in_.pass(outer_, inner_), out = out_.pass(inner_, outer_);
    has_more_ = in || out;
  }
  bool has_more() const { return has_more_; }
  bool is_open() const { return inner_.is_shaken(); }
  bool has_ended() const { return outer_.has_ended() || inner_.has_ended() || refused_; }
  Clock::time_point deadline() const { return deadline_; }
  std::array<pollfd, 2> waits() const { return {outer_.waits(), inner_.waits()}; }

 private:
  /// Fast DDS is called only for who has keys.
  bool call() {
    if (std::exchange(called_, true)) return true;
    refused_ = ::connect(inner_.handle(), reinterpret_cast<const sockaddr*>(&inner_at_),
                         sizeof inner_at_) != 0 &&
               errno != EINPROGRESS;
    return !refused_;
  }

  Side outer_, inner_;
  sockaddr_in inner_at_{};
  Way in_, out_;
  bool called_ = false, refused_ = false, has_more_ = false;
  Clock::time_point deadline_ = Clock::now() + handshake_time;
};

}  // namespace prehend::dds::tls

namespace prehend::dds {

class TlsFront::Loop {
 public:
  Loop(tls::Context context, tls::Socket door, std::uint16_t inner)
      : context_(std::move(context)),
        door_(std::move(door)),
        inner_(inner),
        wake_(::eventfd(0, EFD_CLOEXEC)),
        thread_([this] { run(); }) {}
  ~Loop() {
    const std::uint64_t one = 1;
    (void)!::write(wake_.handle(), &one, sizeof one);
    thread_.join();
  }

 private:
  void run() {
    // Whoever hangs up must not end the process.
    sigset_t pipes;
    ::sigemptyset(&pipes);
    ::sigaddset(&pipes, SIGPIPE);
    ::pthread_sigmask(SIG_BLOCK, &pipes, nullptr);
    std::vector<pollfd> files;
    while (true) {
      files.assign({{wake_.handle(), POLLIN, 0}, {door_.handle(), POLLIN, 0}});
      for (const tls::Connection& one : connections_)
        for (const pollfd& file : one.waits()) files.push_back(file);
      if (::poll(files.data(), files.size(), patience()) < 0 && errno != EINTR) return;
      if (files[0].revents != 0) return;
      // Those of poll(); who comes now begins at once, too.
      auto file = files.begin() + 2;
      for (auto one = connections_.begin(); one != connections_.end() && file != files.end();
           ++one, file += 2)
        if (file[0].revents != 0 || file[1].revents != 0 || one->has_more()) one->go_on();
      if (files[1].revents != 0) let_in();
      forget_ended();
    }
  }

  /// Until the next greeting has lasted too long, ms.
  int patience() const {
    auto until = tls::Clock::time_point::max();
    for (const tls::Connection& one : connections_)
      if (one.has_more())
        return 0;
      else if (!one.is_open())
        until = std::min(until, one.deadline());
    if (until == tls::Clock::time_point::max()) return -1;
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - tls::Clock::now());
    return static_cast<int>(std::max<std::int64_t>(0, left.count()));
  }

  void let_in() {
    while (true) {
      tls::Socket guest(::accept4(door_.handle(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
      if (guest.handle() < 0) {
        if (errno == ECONNABORTED || errno == EINTR) continue;
        // No more files: those who come wait at the door.
        if (errno == EMFILE || errno == ENFILE)
          std::this_thread::sleep_for(std::chrono::milliseconds(50));
        return;
      }
      make_room();
      connections_.emplace_back(std::move(guest), context_.get(), inner_).go_on();
    }
  }

  void make_room() {
    const auto waits = [](const tls::Connection& one) { return !one.is_open(); };
    const auto waiting = std::ranges::count_if(connections_, waits);
    if (static_cast<std::size_t>(waiting) < tls::max_waiting && connections_.size() < tls::max_open)
      return;
    const auto oldest = std::ranges::find_if(connections_, waits);
    if (oldest != connections_.end()) connections_.erase(oldest);
  }

  void forget_ended() {
    const auto now = tls::Clock::now();
    std::erase_if(connections_, [&](const tls::Connection& one) {
      return one.has_ended() || (!one.is_open() && now >= one.deadline());
    });
  }

  tls::Context context_;
  tls::Socket door_;
  std::uint16_t inner_;
  tls::Socket wake_;
  std::list<tls::Connection> connections_;  // the oldest first
  std::thread thread_;                      // last: uses the rest
};

Expected<std::unique_ptr<TlsFront>> TlsFront::create(const Options& options) {
  auto context = tls::context_of(options);
  if (!context) return tl::unexpected(context.error());
  tls::Socket door = tls::tcp_socket();
  const int on = 1;
  ::setsockopt(door.handle(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  const sockaddr_in here = tls::address(INADDR_ANY, options.port);
  if (::bind(door.handle(), reinterpret_cast<const sockaddr*>(&here), sizeof here) != 0 ||
      ::listen(door.handle(), SOMAXCONN) != 0)
    return fail(std::strerror(errno), "TCP port " + std::to_string(options.port));
  return std::unique_ptr<TlsFront>(
      new TlsFront(std::make_unique<Loop>(std::move(*context), std::move(door), options.inner)));
}

TlsFront::TlsFront(std::unique_ptr<Loop> loop) : loop_(std::move(loop)) {}
TlsFront::~TlsFront() = default;

std::uint16_t free_inner_port() {
  const tls::Socket socket = tls::tcp_socket();
  sockaddr_in here = tls::address(INADDR_LOOPBACK, 0);
  socklen_t size = sizeof here;
  if (::bind(socket.handle(), reinterpret_cast<const sockaddr*>(&here), sizeof here) != 0 ||
      ::getsockname(socket.handle(), reinterpret_cast<sockaddr*>(&here), &size) != 0)
    return 0;
  return ntohs(here.sin_port);
}

}  // namespace prehend::dds
