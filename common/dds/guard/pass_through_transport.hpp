#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <vector>

#include "common/dds/release/fastdds.hpp"

namespace prehend::dds {

/// Ports of samples are odd, those of discovery even (RTPS 2.2, 9.6.1.1). By TCP all share one.
inline bool carries_samples(const rtps::Locator_t& locator) {
  return locator.kind == LOCATOR_KIND_UDPv4 && locator.port % 2 == 1;
}

/// A transport around another one that changes nothing: what stands between Fast DDS and its
/// transports begins with this.
class PassThroughTransport : public transport::ChainingTransport {
 public:
  explicit PassThroughTransport(const transport::ChainingTransportDescriptor& descriptor)
      : ChainingTransport(descriptor) {}

  transport::TransportDescriptorInterface* get_configuration() override {
    return low_level_transport_->get_configuration();
  }
#if PREHEND_FAST_DDS == 2
  using Bytes = const rtps::octet*;
#else  // Fast DDS 3 gives a message in pieces
  using Bytes = const std::vector<transport::NetworkBuffer>&;
#endif
  bool send(rtps::SenderResource* lower, Bytes bytes, std::uint32_t size,
            rtps::LocatorsIterator* begin, rtps::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& timeout) override {
    return lower->send(bytes, size, begin, end, timeout);
  }
  void receive(transport::TransportReceiverInterface* next, const rtps::octet* bytes,
               std::uint32_t size, const rtps::Locator_t& local,
               const rtps::Locator_t& remote) override {
    next->OnDataReceived(bytes, size, local, remote);
  }
  /// The lower transport's own resources, not wrapped: send() of this class is not asked.
  bool OpenOutputChannel(transport::SendResourceList& senders,
                         const rtps::Locator_t& remote) override {
    return low_level_transport_->OpenOutputChannel(senders, remote);
  }

 protected:
  /// The same, but send() sees what is sent. The lower transport looks for its own resources to use
  /// them again: it has a list of them, and Fast DDS gets one of ours for each.
  bool open_wrapped(transport::SendResourceList& senders, const rtps::Locator_t& remote) {
    if (!low_level_transport_->OpenOutputChannel(lower_, remote)) return false;
    for (; wrapped_ < lower_.size(); ++wrapped_)
      senders.push_back(std::make_unique<Sender>(*this, *lower_[wrapped_]));
    return true;
  }

 private:
  class Sender final : public rtps::SenderResource {
   public:
    Sender(PassThroughTransport& through, rtps::SenderResource& lower)
        : SenderResource(lower.kind()) {
      const auto send = [&through, &lower](Bytes bytes, std::uint32_t size,
                                           rtps::LocatorsIterator* begin,
                                           rtps::LocatorsIterator* end,
                                           const std::chrono::steady_clock::time_point& timeout) {
        return through.send(&lower, bytes, size, begin, end, timeout);
      };
#if PREHEND_FAST_DDS == 2
      send_lambda_ = send;
#else
      send_buffers_lambda_ = send;
#endif
    }
  };

  transport::SendResourceList lower_;
  std::size_t wrapped_ = 0;  // of these
};

}  // namespace prehend::dds
