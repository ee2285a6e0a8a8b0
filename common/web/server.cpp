#include "common/web/server.hpp"

#include <algorithm>

#include "common/web/session.hpp"

namespace prehend::web {
namespace {

std::string text(beast::string_view view) {
  return {view.data(), view.size()};
}

class BeastServer final : public Server {
 public:
  BeastServer(const Options& options, Site& site)
      : connections_{site, options, {}},
        security_(asio::ssl::context::tls_server),
        acceptor_(context_),
        pause_(context_),
        timer_(context_) {}
  ~BeastServer() override {
    end();
    // Who is connected is kept by what the context still holds: they go with it, before the rest.
    for (Connection* one : std::list(connections_.all)) one->close();
    context_.restart();
    context_.poll();
  }

  Expected<void> open() {
    const Options& options = connections_.options;
    const std::string where = options.address + ":" + std::to_string(options.port);
    Code failed;
    const auto address = asio::ip::make_address(
        options.address == "localhost" ? std::string("127.0.0.1") : options.address, failed);
    if (failed)
      return wrong_use("is no address", options.address, "an address of this host, as 127.0.0.1");
    if (!options.certificate.empty()) {
      security_.use_certificate_chain(asio::buffer(options.certificate), failed);
      if (failed) return fail(failed.message(), "the certificate of the server", "a text in PEM");
      security_.use_private_key(asio::buffer(options.key), asio::ssl::context::pem, failed);
      if (failed)
        return fail(failed.message(), "the key of the server", "that of the certificate, in PEM");
    }
    const asio::ip::tcp::endpoint end(address, static_cast<unsigned short>(options.port));
    acceptor_.open(end.protocol(), failed);
    if (!failed) acceptor_.set_option(asio::socket_base::reuse_address(true), failed);
    if (!failed) acceptor_.bind(end, failed);
    if (!failed) acceptor_.listen(asio::socket_base::max_listen_connections, failed);
    if (failed) return fail(failed.message(), where, "does another one serve there?");
    accept();
    await_tick(Clock::now() + options.period);
    return {};
  }

  int port() const override { return acceptor_.local_endpoint().port(); }
  std::size_t clients() const override { return connections_.all.size(); }
  void run() override { context_.run(); }
  void run_for(Duration time) override { context_.run_for(time); }

  void wake() override {
    asio::post(context_, [this] {
      const Options& options = connections_.options;
      const Instant at = std::max(Clock::now() + options.together, ticked_ + options.soonest);
      if (!stopping_ && at < timer_.expiry()) await_tick(at);
    });
  }

  void stop() override {
    asio::post(context_, [this] {
      end();
      context_.stop();
    });
  }

 private:
  using Instant = Clock::time_point;

  void end() {
    stopping_ = true;
    Code ignored;
    acceptor_.close(ignored);
    pause_.cancel();
    timer_.cancel();
  }

  void accept() {
    acceptor_.async_accept([this](Code failed, asio::ip::tcp::socket socket) {
      if (stopping_ || failed == asio::error::operation_aborted) return;
      if (failed == asio::error::connection_aborted) return accept();
      // Without descriptors it would fail at once, again and again.
      if (failed) return retry();
      if (connections_.all.size() < connections_.options.max_clients || make_room())
        begin(std::move(socket));
      accept();
    });
  }

  void retry() {
    make_room();
    pause_.expires_after(std::chrono::milliseconds(100));
    pause_.async_wait([this](Code failed) {
      if (!failed && !stopping_) accept();
    });
  }

  /// Who has not said what it wants goes first. False: all are open WebSockets.
  bool make_room() {
    for (const Phase phase : {Phase::asks, Phase::leaves, Phase::is_answered}) {
      const auto oldest = std::ranges::find(connections_.all, phase, &Connection::phase);
      if (oldest == connections_.all.end()) continue;
      (*oldest)->close();
      return true;
    }
    return false;
  }

  void begin(asio::ip::tcp::socket socket) {
    Code ignored;
    socket.set_option(asio::ip::tcp::no_delay(true), ignored);
    beast::tcp_stream stream(std::move(socket));
    if (connections_.options.certificate.empty())
      std::make_shared<Session<beast::tcp_stream>>(std::move(stream), connections_)->start();
    else
      std::make_shared<Session<beast::ssl_stream<beast::tcp_stream>>>(
          beast::ssl_stream<beast::tcp_stream>(std::move(stream), security_), connections_)
          ->start();
  }

  /// Instead of what was waited for before.
  void await_tick(Instant at) {
    timer_.expires_at(at);
    timer_.async_wait([this](Code failed) {
      if (failed || stopping_) return;
      ticked_ = Clock::now();
      connections_.site.tick();
      // Those that are let go leave the list meanwhile.
      for (Connection* one : std::list(connections_.all)) one->flush();
      // A late tick is not made up for.
      await_tick(Clock::now() + connections_.options.period);
    });
  }

  Connections connections_;
  asio::io_context context_{1};
  asio::ssl::context security_;
  asio::ip::tcp::acceptor acceptor_;
  asio::steady_timer pause_;  // until it accepts again
  asio::steady_timer timer_;  // of the ticks
  Instant ticked_{};
  bool stopping_ = false;
};

/// Those who read such a request otherwise are tricked by it.
bool names_its_host(const http::request<http::string_body>& request) {
  const auto count = request.count(http::field::host);
  return count == 1 || (count == 0 && request.version() < 11);
}

}  // namespace

std::variant<Request, int> request_of(const http::request<http::string_body>& request) {
  if (!names_its_host(request)) return 400;
  Request made{text(request.method_string()),
               text(request.target()),
               request.body(),
               beast::websocket::is_upgrade(request),
               {}};
  for (const auto& field : request)
    made.fields.emplace_back(text(field.name_string()), text(field.value()));
  return made;
}

std::optional<int> refusal_of(Code failed) {
  if (failed == http::error::header_limit || failed == http::error::buffer_overflow) return 431;
  if (failed == http::error::body_limit) return 413;
  if (failed == http::error::bad_version) return 505;
  if (failed.category() != http::make_error_code(http::error::bad_field).category() ||
      failed == http::error::end_of_stream || failed == http::error::partial_message)
    return std::nullopt;
  return 400;
}

Answer refuse(int status) {
  return plain(status, text(http::obsolete_reason(static_cast<http::status>(status))));
}

http::response<http::string_body> response_of(Answer answer, bool only_head) {
  http::response<http::string_body> response(static_cast<http::status>(answer.status), 11);
  response.set(http::field::content_type, answer.type);
  response.set(http::field::cache_control, "no-store");
  for (const auto& [name, value] : answer.fields) response.set(name, value);
  response.keep_alive(false);
  response.content_length(answer.body.size());
  if (!only_head) response.body() = std::move(answer.body);
  return response;
}

Expected<std::unique_ptr<Server>> Server::listen(const Options& options, Site& site) {
  auto made = std::make_unique<BeastServer>(options, site);
  if (auto opened = made->open(); !opened) return tl::unexpected(opened.error());
  return made;
}

}  // namespace prehend::web
