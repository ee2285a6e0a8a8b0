#include "services/glove/devices/landmarks.hpp"

#include "services/glove/devices/datagrams.hpp"
#include "services/glove/devices/hand_feed.hpp"

namespace prehend::glove {
namespace {

class DatagramFeed final : public HandFeed {
 public:
  explicit DatagramFeed(DatagramReceiver socket) : socket_(std::move(socket)) {}

  Expected<Came> read(Duration timeout) override {
    const auto datagram = socket_.read(timeout);
    if (!datagram) return tl::unexpected(datagram.error());
    Came came{.refused = datagram->refused};
    for (const std::string_view text : documents_in(datagram->bytes))
      came.hands.push_back(parse_landmarks(text));
    return came;
  }

 private:
  DatagramReceiver socket_;
};

/// Sends a line for every measurement, without a stamp: it has no clock.
class LandmarksEmulator final : public Emulator {
 public:
  explicit LandmarksEmulator(const DeviceOptions& options) : teller_(options) {}

  std::string receive(std::string_view, Duration) override { return {}; }
  std::vector<std::string> measure(const Frame& frame, Duration) override {
    const auto line = teller_.tell(frame);
    return line ? std::vector{to_line(*line) + "\n"} : std::vector<std::string>();
  }

 private:
  HandTeller teller_;
};

}  // namespace

Expected<std::unique_ptr<Device>> create_landmarks(const DeviceOptions& options) {
  ReceiverOptions receiver{.address = options.port.empty() ? landmarks_address : options.port,
                           .senders = options.senders,
                           .token = options.token,
                           .secured = options.secured};
  if (const auto good = DatagramReceiver::check(receiver); !good)
    return tl::unexpected(good.error());
  return make_bare_hand(options, {.open = [receiver]() -> Expected<std::unique_ptr<HandFeed>> {
                                    auto socket = DatagramReceiver::bind(receiver);
                                    if (!socket) return tl::unexpected(socket.error());
                                    return std::make_unique<DatagramFeed>(std::move(*socket));
                                  },
                                  .where = receiver.address,
                                  .advice = "start the hand tracking program"});
}

std::unique_ptr<Emulator> emulate_landmarks(const DeviceOptions& options) {
  return std::make_unique<LandmarksEmulator>(options);
}

}  // namespace prehend::glove
