#pragma once

#include <array>
#include <boost/asio.hpp>
#include <boost/asio/ssl.hpp>
#include <boost/beast.hpp>
#include <boost/beast/ssl.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <type_traits>

#include "services/console/service/web/server.hpp"

namespace prehend::console::web {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using Code = boost::system::error_code;

// Only server.cpp includes this header, and server.hpp before it: Boost 1.74 lacks <utility> in
// C++20.

/// Someone who is connected.
class Connection {
 public:
  virtual ~Connection() = default;
  /// Begins to send what there is, unless it is about it.
  virtual void flush() = 0;
  virtual void close() = 0;
};

/// All who are connected.
struct Connections {
  Site& site;
  Server::Options options;
  std::set<Connection*> all;
};

inline constexpr std::size_t max_head = 8192, max_body = 2048, max_request = 65536;

inline std::string text(beast::string_view view) {
  return {view.data(), view.size()};
}

Asked asked_of(const http::request<http::string_body>& request);
http::response<http::string_body> response_of(const http::request<http::string_body>& request,
                                              Answer answer, bool secure);

/// One connection: a request and its answer, or a WebSocket until its end. It keeps itself.
/// Stream: plain or TLS.
template <class Stream>
class Session : public Connection, public std::enable_shared_from_this<Session<Stream>> {
 public:
  static constexpr bool secure = !std::is_same_v<Stream, beast::tcp_stream>;

  Session(Stream stream, Connections& connections)
      : stream_(std::move(stream)), connections_(connections) {
    connections_.all.insert(this);
  }
  ~Session() override {
    connections_.all.erase(this);
    if (client_) connections_.site.hub().disconnect(*client_);
  }

  void start() {
    beast::get_lowest_layer(stream_).expires_after(connections_.options.patience);
    if constexpr (secure) {
      stream_.async_handshake(asio::ssl::stream_base::server,
                              [self = this->shared_from_this()](Code failed) {
                                if (!failed) self->read_request();
                              });
    } else {
      read_request();
    }
  }

  void flush() override {
    if (!socket_ || !client_ || writing_) return;
    Hub& hub = connections_.site.hub();
    if (hub.overflowed(*client_)) return close();
    auto frame = hub.next(*client_);
    if (!frame) return;
    writing_ = true;
    frame_ = std::move(*frame);
    socket_->binary(frame_.binary);
    const std::array<asio::const_buffer, 2> parts{
        asio::buffer(frame_.head),
        frame_.payload ? asio::buffer(*frame_.payload) : asio::const_buffer()};
    socket_->async_write(parts, [self = this->shared_from_this()](Code failed, std::size_t) {
      self->writing_ = false;
      self->frame_ = {};
      if (!failed) self->flush();
    });
  }

  void close() override {
    Code ignored;
    if (socket_)
      beast::get_lowest_layer(*socket_).socket().close(ignored);
    else
      beast::get_lowest_layer(stream_).socket().close(ignored);
  }

 private:
  void read_request() {
    parser_.header_limit(max_head);
    parser_.body_limit(max_body);
    http::async_read(stream_, buffer_, parser_,
                     [self = this->shared_from_this()](Code failed, std::size_t) {
                       if (!failed) self->on_request();
                     });
  }

  void on_request() {
    const auto& request = parser_.get();
    Asked asked = asked_of(request);
    const Verdict verdict = connections_.site.judge(asked);
    if (verdict.route == Route::socket) return upgrade(verdict.what, verdict.orders);
    response_ = response_of(request, connections_.site.answer(verdict, request.body()), secure);
    http::async_write(stream_, response_,
                      [self = this->shared_from_this()](Code failed, std::size_t) {
                        if (!failed) self->finish();
                      });
  }

  void finish() {
    if constexpr (secure) {
      stream_.async_shutdown([self = this->shared_from_this()](Code) {});
    } else {
      Code ignored;
      stream_.socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
    }
  }

  void upgrade(const std::string& protocol, bool orders) {
    beast::get_lowest_layer(stream_).expires_never();
    socket_.emplace(std::move(stream_));
    beast::websocket::stream_base::timeout times{};
    times.handshake_timeout = connections_.options.patience;
    times.idle_timeout = 6 * connections_.options.patience;
    times.keep_alive_pings = true;
    socket_->set_option(times);
    socket_->read_message_max(max_request);
    // A message in one write, however large.
    socket_->auto_fragment(false);
    socket_->set_option(beast::websocket::stream_base::decorator(
        [protocol](beast::websocket::response_type& response) {
          response.set(http::field::sec_websocket_protocol, protocol);
        }));
    socket_->async_accept(parser_.get(), [self = this->shared_from_this(), orders](Code failed) {
      if (failed) return;
      self->client_ = self->connections_.site.hub().connect(orders);
      self->buffer_.consume(self->buffer_.size());
      self->listen();
      self->flush();
    });
  }

  void listen() {
    socket_->async_read(buffer_, [self = this->shared_from_this()](Code failed, std::size_t) {
      if (failed) return;
      const auto bytes = self->buffer_.cdata();
      const std::string_view said{static_cast<const char*>(bytes.data()), bytes.size()};
      Hub& hub = self->connections_.site.hub();
      if (self->socket_->got_text())
        hub.hear(*self->client_, said);
      else
        hub.hear_bytes(*self->client_, said);
      self->buffer_.consume(self->buffer_.size());
      self->flush();
      self->listen();
    });
  }

  Stream stream_;
  Connections& connections_;
  beast::flat_buffer buffer_;
  http::request_parser<http::string_body> parser_;
  http::response<http::string_body> response_;
  std::optional<beast::websocket::stream<Stream>> socket_;
  std::optional<Hub::Client> client_;
  Frame frame_;
  bool writing_ = false;
};

}  // namespace prehend::console::web
