#pragma once

#include <netinet/in.h>

#include <string>
#include <string_view>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "services/glove/devices/emulator.hpp"

namespace prehend::glove {

/// An IPv4 address and a port as text, "127.0.0.1:9870".
Expected<sockaddr_in> parse_address(const std::string& text);

/// A UDP socket that receives. Not for several threads at once.
class DatagramReceiver {
 public:
  static Expected<DatagramReceiver> bind(const std::string& address);
  DatagramReceiver(DatagramReceiver&& other) noexcept;
  DatagramReceiver& operator=(DatagramReceiver&&) = delete;
  ~DatagramReceiver();

  /// The next datagram, as soon as there is one; empty when none came in time.
  Expected<std::string> read(Duration timeout);

 private:
  explicit DatagramReceiver(std::string address) : address_(std::move(address)) {}
  std::string address_;
  int socket_ = -1;
};

/// A UDP socket that sends, to nobody perhaps.
class DatagramSender final : public Plug {
 public:
  static Expected<DatagramSender> create(const std::string& address);
  DatagramSender(DatagramSender&& other) noexcept;
  DatagramSender& operator=(DatagramSender&&) = delete;
  ~DatagramSender() override;

  std::string read(Duration timeout) override;
  void write(std::string_view datagram) override;
  std::string where() const override { return address_; }

 private:
  explicit DatagramSender(std::string address) : address_(std::move(address)) {}
  std::string address_;
  sockaddr_in to_{};
  int socket_ = -1;
};

}  // namespace prehend::glove
