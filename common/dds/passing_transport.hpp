#pragma once

#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>

namespace prehend::dds {

/// A transport around another one that changes nothing: what stands between Fast DDS and its
/// transports begins with this.
class PassingTransport : public eprosima::fastdds::rtps::ChainingTransport {
 public:
  explicit PassingTransport(const eprosima::fastdds::rtps::ChainingTransportDescriptor& descriptor)
      : ChainingTransport(descriptor) {}

  eprosima::fastdds::rtps::TransportDescriptorInterface* get_configuration() override {
    return low_level_transport_->get_configuration();
  }
  bool send(eprosima::fastrtps::rtps::SenderResource* lower,
            const eprosima::fastrtps::rtps::octet* bytes, std::uint32_t size,
            eprosima::fastrtps::rtps::LocatorsIterator* begin,
            eprosima::fastrtps::rtps::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& timeout) override {
    return lower->send(bytes, size, begin, end, timeout);
  }
  void receive(eprosima::fastdds::rtps::TransportReceiverInterface* next,
               const eprosima::fastrtps::rtps::octet* bytes, std::uint32_t size,
               const eprosima::fastrtps::rtps::Locator_t& local,
               const eprosima::fastrtps::rtps::Locator_t& remote) override {
    next->OnDataReceived(bytes, size, local, remote);
  }
  /// The lower transport's own resources, not wrapped: it looks for them to use a connection again.
  bool OpenOutputChannel(eprosima::fastdds::rtps::SendResourceList& senders,
                         const eprosima::fastrtps::rtps::Locator_t& remote) override {
    return low_level_transport_->OpenOutputChannel(senders, remote);
  }
};

}  // namespace prehend::dds
