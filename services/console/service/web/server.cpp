#include "services/console/service/web/server.hpp"

#include <algorithm>

#include "services/console/service/web/session.hpp"

namespace prehend::console::web {

namespace {

/// Nothing of others runs in the page, nobody frames it, and it speaks to its own server alone.
/// Hand tracking is WebAssembly.
constexpr const char* content_policy =
    "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; "
    "img-src 'self' data: blob:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

class BeastServer final : public Server {
 public:
  BeastServer(const Options& options, Site& site)
      : connections_{site, options, {}},
        security_(asio::ssl::context::tls_server),
        acceptor_(context_),
        timer_(context_) {}

  Expected<void> open() {
    const Options& options = connections_.options;
    const std::string where = options.address + ":" + std::to_string(options.port);
    Code failed;
    const auto address = asio::ip::make_address(
        options.address == "localhost" ? std::string("127.0.0.1") : options.address, failed);
    if (failed) return wrong_use("is no address", options.address, "console.address");
    if (!options.certificate.empty()) {
      security_.use_certificate_chain(asio::buffer(options.certificate), failed);
      if (failed) return fail(failed.message(), "console.certificate", "a certificate in PEM");
      security_.use_private_key(asio::buffer(options.key), asio::ssl::context::pem, failed);
      if (failed) return fail(failed.message(), "console.key", "that of the certificate, in PEM");
    }
    const asio::ip::tcp::endpoint end(address, static_cast<unsigned short>(options.port));
    acceptor_.open(end.protocol(), failed);
    if (!failed) acceptor_.set_option(asio::socket_base::reuse_address(true), failed);
    if (!failed) acceptor_.bind(end, failed);
    if (!failed) acceptor_.listen(asio::socket_base::max_listen_connections, failed);
    if (failed) return fail(failed.message(), where, "see console.address and console.port");
    return {};
  }

  int port() const override { return acceptor_.local_endpoint().port(); }

  void run() override {
    accept();
    await_tick(asio::steady_timer::clock_type::now() + connections_.options.period);
    context_.run();
    // Who is connected is kept by what the context still holds: they go with it, before the rest.
    for (Connection* one : connections_.all) one->close();
    context_.restart();
    context_.poll();
  }

  void wake() override {
    asio::post(context_, [this] {
      const Options& options = connections_.options;
      const Instant at = std::max(asio::steady_timer::clock_type::now() + options.together,
                                  ticked_ + options.soonest);
      if (!stopping_ && at < timer_.expiry()) await_tick(at);
    });
  }

  void stop() override {
    asio::post(context_, [this] {
      stopping_ = true;
      Code ignored;
      acceptor_.close(ignored);
      timer_.cancel();
      context_.stop();
    });
  }

 private:
  using Instant = asio::steady_timer::time_point;

  void accept() {
    acceptor_.async_accept([this](Code failed, asio::ip::tcp::socket socket) {
      if (stopping_ || failed == asio::error::operation_aborted) return;
      // Without descriptors it would fail at once, again and again.
      if (failed) return retry();
      if (connections_.all.size() < connections_.options.max_clients) begin(std::move(socket));
      accept();
    });
  }

  void retry() {
    auto pause = std::make_shared<asio::steady_timer>(context_, std::chrono::milliseconds(100));
    pause->async_wait([this, pause](Code failed) {
      if (!failed && !stopping_) accept();
    });
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
      ticked_ = asio::steady_timer::clock_type::now();
      connections_.site.tick();
      // Those that are let go leave the set meanwhile.
      const std::vector<Connection*> all(connections_.all.begin(), connections_.all.end());
      for (Connection* one : all)
        if (connections_.all.contains(one)) one->flush();
      // A late tick is not made up for.
      await_tick(asio::steady_timer::clock_type::now() + connections_.options.period);
    });
  }

  Connections connections_;
  asio::io_context context_{1};
  asio::ssl::context security_;
  asio::ip::tcp::acceptor acceptor_;
  asio::steady_timer timer_;
  Instant ticked_{};
  bool stopping_ = false;
};

}  // namespace

Asked asked_of(const http::request<http::string_body>& request) {
  const auto all = [&](auto field) {
    std::string joined;
    const auto range = request.equal_range(field);
    for (auto at = range.first; at != range.second; ++at)
      joined += (joined.empty() ? "" : ",") + text(at->value());
    return joined;
  };
  return {text(request.method_string()),
          text(request.target()),
          all(http::field::host),
          all(http::field::origin),
          all("X-Prehend-Token"),
          all(http::field::cookie),
          beast::websocket::is_upgrade(request),
          all(http::field::sec_websocket_protocol)};
}

http::response<http::string_body> response_of(const http::request<http::string_body>& request,
                                              Answer answer, bool secure) {
  http::response<http::string_body> response(static_cast<http::status>(answer.status),
                                             request.version());
  response.set(http::field::content_type, answer.type);
  response.set(http::field::cache_control, "no-store");
  response.set("Content-Security-Policy", content_policy);
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Referrer-Policy", "no-referrer");
  response.set("Cross-Origin-Resource-Policy", "same-origin");
  if (!answer.cookie.empty())
    response.set(http::field::set_cookie, "prehend=" + answer.cookie +
                                              "; Path=/; HttpOnly; SameSite=Strict" +
                                              (secure ? "; Secure" : ""));
  response.keep_alive(false);
  response.content_length(answer.body.size());
  if (request.method() != http::verb::head) response.body() = std::move(answer.body);
  return response;
}

Expected<std::unique_ptr<Server>> Server::listen(const Options& options, Site& site) {
  auto made = std::make_unique<BeastServer>(options, site);
  if (auto opened = made->open(); !opened) return tl::unexpected(opened.error());
  return made;
}

}  // namespace prehend::console::web
