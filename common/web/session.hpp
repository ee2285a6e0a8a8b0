#pragma once

#include <algorithm>
#include <array>
#include <boost/asio.hpp>
#include <boost/asio/ssl.hpp>
#include <boost/beast.hpp>
#include <boost/beast/ssl.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <cstdint>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>

#include "common/web/server.hpp"

namespace prehend::web {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using Code = boost::system::error_code;
using Clock = std::chrono::steady_clock;

// Only sources of this folder include this header, and site.hpp before it: Boost 1.74 lacks
// <utility> in C++20.

/// Of a request, and of a message of a WebSocket.
inline constexpr std::size_t max_head = 8192, max_body = 2048, max_message = 65536;
/// Time and bytes that are waited for and thrown away after the answer: a socket that is closed
/// with something unread takes the answer with it.
inline constexpr auto farewell = std::chrono::seconds(1);
inline constexpr std::size_t max_thrown_away = 65536;

/// It asks, is sent its answer, has got it and is to hang up; or it is an open WebSocket.
enum class Phase : std::uint8_t { asks, is_answered, leaves, is_open };

/// Someone who is connected.
class Connection {
 public:
  virtual ~Connection() = default;
  /// Begins to send what there is, unless it is about it.
  virtual void flush() = 0;
  virtual void close() = 0;
  Phase phase() const { return phase_; }

 protected:
  Phase phase_ = Phase::asks;
};

/// All who are connected.
struct Connections {
  Site& site;
  Server::Options options;
  std::list<Connection*> all;  // in the order in which they came
};

/// A sound request in our words; a status of HTTP: what is wrong with it.
std::variant<Request, int> request_of(const http::request<http::string_body>& request);
/// Of what could not be read; nothing: it has not come to its end, and nobody waits for an answer.
std::optional<int> refusal_of(Code failed);
Answer refuse(int status);
http::response<http::string_body> response_of(Answer answer, bool only_head);

/// One connection: a request and its answer, or a WebSocket until its end. It keeps itself.
/// Stream: plain or TLS.
template <class Stream>
class Session : public Connection, public std::enable_shared_from_this<Session<Stream>> {
 public:
  static constexpr bool secure = !std::is_same_v<Stream, beast::tcp_stream>;

  Session(Stream stream, Connections& connections)
      : stream_(std::move(stream)), connections_(connections) {
    connections_.all.push_back(this);
  }
  ~Session() override { connections_.all.remove(this); }

  void start() {
    deadline_ = Clock::now() + connections_.options.patience;
    beast::get_lowest_layer(stream_).expires_at(deadline_);
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
    if (phase_ != Phase::is_open || writing_) return;
    if (channel_->overflowed()) return close();
    auto frame = channel_->next();
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
    // Whoever takes its place does not wait until its last operation has ended.
    connections_.all.remove(this);
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
                       if (!failed)
                         self->on_request();
                       else if (const auto status = refusal_of(failed))
                         self->send(refuse(*status), false);
                     });
  }

  void on_request() {
    const bool only_head = parser_.get().method() == http::verb::head;
    const auto request = request_of(parser_.get());
    if (const auto* status = std::get_if<int>(&request)) return send(refuse(*status), only_head);
    auto answer = connections_.site.answer(std::get<Request>(request));
    if (auto* to_socket = std::get_if<Upgrade>(&answer)) return upgrade(std::move(*to_socket));
    send(std::get<Answer>(std::move(answer)), only_head);
  }

  void send(Answer answer, bool only_head) {
    phase_ = Phase::is_answered;
    response_ = response_of(std::move(answer), only_head);
    http::async_write(stream_, response_,
                      [self = this->shared_from_this()](Code failed, std::size_t) {
                        if (!failed) self->finish();
                      });
  }

  void finish() {
    phase_ = Phase::leaves;
    response_ = {};
    beast::get_lowest_layer(stream_).expires_at(std::min(deadline_, Clock::now() + farewell));
    if constexpr (secure) {
      stream_.async_shutdown([self = this->shared_from_this()](Code) {});
    } else {
      Code ignored;
      stream_.socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
      throw_away();
    }
  }

  void throw_away() {
    buffer_.clear();
    stream_.async_read_some(buffer_.prepare(2048),
                            [self = this->shared_from_this()](Code failed, std::size_t size) {
                              self->thrown_away_ += size;
                              if (!failed && self->thrown_away_ <= max_thrown_away)
                                self->throw_away();
                            });
  }

  void upgrade(Upgrade to_socket) {
    channel_ = std::move(to_socket.channel);
    beast::get_lowest_layer(stream_).expires_never();
    socket_.emplace(std::move(stream_));
    beast::websocket::stream_base::timeout times{};
    times.handshake_timeout = connections_.options.patience;
    times.idle_timeout = 6 * connections_.options.patience;
    times.keep_alive_pings = true;
    socket_->set_option(times);
    socket_->read_message_max(max_message);
    // A message in one write, however large.
    socket_->auto_fragment(false);
    socket_->set_option(beast::websocket::stream_base::decorator(
        [protocol = to_socket.protocol](beast::websocket::response_type& response) {
          response.set(http::field::sec_websocket_protocol, protocol);
        }));
    socket_->async_accept(parser_.get(), [self = this->shared_from_this()](Code failed) {
      if (failed) return;
      self->phase_ = Phase::is_open;
      self->buffer_.consume(self->buffer_.size());
      self->listen();
      self->flush();
    });
  }

  void listen() {
    socket_->async_read(buffer_, [self = this->shared_from_this()](Code failed, std::size_t) {
      if (failed) return;
      const auto bytes = self->buffer_.cdata();
      self->channel_->hear({static_cast<const char*>(bytes.data()), bytes.size()},
                           !self->socket_->got_text());
      self->buffer_.consume(self->buffer_.size());
      self->flush();
      self->listen();
    });
  }

  Stream stream_;
  Connections& connections_;
  Clock::time_point deadline_{};  // of the answer
  beast::flat_buffer buffer_;
  http::request_parser<http::string_body> parser_;
  http::response<http::string_body> response_;
  std::size_t thrown_away_ = 0;
  std::optional<beast::websocket::stream<Stream>> socket_;
  std::unique_ptr<Channel> channel_;
  Frame frame_;
  bool writing_ = false;
};

}  // namespace prehend::web
