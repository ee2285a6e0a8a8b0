#include "packet.hpp"

#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>

#include <algorithm>
#include <atomic>
#include <string_view>

namespace prehend::dds {

namespace transport = eprosima::fastdds::rtps;
namespace rtps = eprosima::fastrtps::rtps;

namespace {

constexpr std::size_t header_size = 20, part_header_size = 4;
constexpr std::uint8_t pad = 0x01, info_timestamp = 0x09;  // may say a length of 0 and mean it
constexpr std::uint8_t statistics = 0x80;                  // of Fast DDS
constexpr std::size_t statistics_size = 56;

std::atomic<std::uint64_t> unsound = 0;

class Guard final : public transport::ChainingTransport {
 public:
  explicit Guard(const transport::ChainingTransportDescriptor& descriptor)
      : ChainingTransport(descriptor), descriptor_(descriptor.low_level_descriptor) {}
  transport::TransportDescriptorInterface* get_configuration() override {
    return descriptor_.get();
  }
  bool send(rtps::SenderResource* lower, const rtps::octet* bytes, std::uint32_t size,
            rtps::LocatorsIterator* begin, rtps::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& timeout) override {
    return lower->send(bytes, size, begin, end, timeout);
  }
  void receive(transport::TransportReceiverInterface* next, const rtps::octet* bytes,
               std::uint32_t size, const rtps::Locator_t& local,
               const rtps::Locator_t& remote) override {
    if (is_sound({bytes, size}))
      next->OnDataReceived(bytes, size, local, remote);
    else
      ++unsound;
  }

 private:
  std::shared_ptr<transport::TransportDescriptorInterface> descriptor_;
};

struct GuardDescriptor final : transport::ChainingTransportDescriptor {
  using ChainingTransportDescriptor::ChainingTransportDescriptor;
  transport::TransportInterface* create_transport() const override { return new Guard(*this); }
};

}  // namespace

bool is_sound(std::span<const std::uint8_t> message) {
  constexpr std::string_view name = "RTPS";
  if (message.size() < header_size || !std::equal(name.begin(), name.end(), message.begin()))
    return false;
  for (std::size_t at = header_size; at < message.size();) {
    if (message.size() - at < part_header_size) return false;
    const std::uint8_t kind = message[at], low = message[at + 2], high = message[at + 3];
    const bool little_endian = message[at + 1] & 1;
    std::size_t length = little_endian ? low + 256u * high : high + 256u * low;
    const std::size_t left = message.size() - at - part_header_size;
    // The last part may leave its length to the message's.
    if (length == 0 && kind != pad && kind != info_timestamp) length = left;
    if (length > left) return false;
    if (kind == statistics && (length != statistics_size || length != left)) return false;
    at += part_header_size + length;
  }
  return true;
}

std::shared_ptr<transport::TransportDescriptorInterface> guarded(
    std::shared_ptr<transport::TransportDescriptorInterface> lower) {
  return std::make_shared<GuardDescriptor>(std::move(lower));
}

std::uint64_t unsound_messages() {
  return unsound;
}

}  // namespace prehend::dds
