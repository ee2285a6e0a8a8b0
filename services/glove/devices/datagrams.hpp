#pragma once

#include <netinet/in.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "common/serial/plug.hpp"

namespace prehend::glove {

/// An IPv4 address and a port as text, "127.0.0.1:9870".
Expected<sockaddr_in> parse_address(const std::string& text);

/// Where datagrams come, and whose are heard. Whoever is heard leads the hand.
struct ReceiverOptions {
  std::string address;               // host:port of this machine
  std::vector<std::string> senders;  // IPv4 addresses; empty: this machine's loopback
  std::string token;                 // the first line of every datagram; empty: none
  /// The lab has keys: beyond loopback it needs both of these, since nothing else asks a sender
  /// who it is.
  bool secured = false;
};

/// What came.
struct Datagram {
  std::string bytes;           // without its token; empty: none came in time, or it was refused
  std::string_view refused{};  // why
};

/// A UDP socket that receives. Not for several threads at once.
class DatagramReceiver {
 public:
  /// What is wrong with the options, before any port is opened.
  static Expected<void> check(const ReceiverOptions& options);
  static Expected<DatagramReceiver> bind(const ReceiverOptions& options);
  DatagramReceiver(DatagramReceiver&& other) noexcept;
  DatagramReceiver& operator=(DatagramReceiver&&) = delete;
  ~DatagramReceiver();

  /// The next datagram, as soon as there is one.
  Expected<Datagram> read(Duration timeout);

 private:
  explicit DatagramReceiver(ReceiverOptions options) : options_(std::move(options)) {}
  bool hears(const sockaddr_in& sender) const;
  ReceiverOptions options_;
  std::vector<in_addr_t> senders_;
  int socket_ = -1;
};

/// A UDP socket that sends, to nobody perhaps. A token goes before every datagram.
class DatagramSender final : public serial::Plug {
 public:
  static Expected<DatagramSender> create(const std::string& address, std::string token = {});
  DatagramSender(DatagramSender&& other) noexcept;
  DatagramSender& operator=(DatagramSender&&) = delete;
  ~DatagramSender() override;

  std::string read(Duration timeout) override;
  void write(std::string_view datagram) override;
  std::string where() const override { return address_; }

 private:
  DatagramSender(std::string address, std::string token)
      : address_(std::move(address)), token_(std::move(token)) {}
  std::string address_, token_;
  sockaddr_in to_{};
  int socket_ = -1;
};

}  // namespace prehend::glove
