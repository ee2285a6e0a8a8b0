#include "services/robot/devices/channel.hpp"

#include <utility>

#include "common/base/clock.hpp"
#include "common/serial/serial_port.hpp"
#include "services/robot/devices/nodes.hpp"

namespace prehend::robot {
namespace {

class SerialChannel final : public Channel {
 public:
  explicit SerialChannel(serial::SerialPort port) : port_(std::move(port)) {}
  Expected<std::string> read() override { return port_.read(Duration::zero()); }
  Expected<void> write(std::string_view said) override { return port_.write(said); }
  Error unanswered(Error silence) const override {
    return port_.overheard().unanswered(std::move(silence));
  }

 private:
  serial::SerialPort port_;
};

class NodesChannel final : public Channel {
 public:
  explicit NodesChannel(std::unique_ptr<Nodes> nodes) : nodes_(std::move(nodes)) {}
  Expected<std::string> read() override { return nodes_->read(Duration::zero()); }
  Expected<void> write(std::string_view said) override { return nodes_->write(said); }

 private:
  std::unique_ptr<Nodes> nodes_;
};

}  // namespace

Opener serial_channel(const std::string& port, int baud) {
  return [=]() -> Expected<std::unique_ptr<Channel>> {
    auto opened = serial::SerialPort::open(port, baud);
    if (!opened) return tl::unexpected(opened.error());
    opened->discard_input();
    return std::make_unique<SerialChannel>(std::move(*opened));
  };
}

Opener nodes_channel(const NodesOptions& options) {
  return [=]() -> Expected<std::unique_ptr<Channel>> {
    auto nodes = Nodes::join(options, Nodes::End::driver);
    if (!nodes) return tl::unexpected(nodes.error());
    return std::make_unique<NodesChannel>(std::move(*nodes));
  };
}

}  // namespace prehend::robot
