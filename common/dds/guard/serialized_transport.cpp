#include "common/dds/guard/serialized_transport.hpp"

#include "common/dds/guard/pass_through_transport.hpp"
#include "common/dds/guard/registry.hpp"

namespace prehend::dds {

namespace {

class SerializingTransport final : public PassThroughTransport {
 public:
  SerializingTransport(const transport::ChainingTransportDescriptor& descriptor,
                       SerializedTransport& serializer)
      : PassThroughTransport(descriptor), serializer_(serializer) {}
  void receive(transport::TransportReceiverInterface* next, const rtps::octet* bytes,
               std::uint32_t size, const rtps::Locator_t& local,
               const rtps::Locator_t& remote) override {
    const auto process = [&] { next->OnDataReceived(bytes, size, local, remote); };
    if (carries_samples(local))
      process();
    else
      serializer_.pass(process);
  }

 private:
  SerializedTransport& serializer_;
};

struct SerializingDescriptor final : transport::ChainingTransportDescriptor {
  SerializingDescriptor(std::shared_ptr<transport::TransportDescriptorInterface> lower,
                        SerializedTransport& one)
      : ChainingTransportDescriptor(std::move(lower)), serializer(one) {}
  transport::TransportInterface* create_transport() const override {
    return new SerializingTransport(*this, serializer);
  }
  SerializedTransport& serializer;
};

}  // namespace

SerializedTransport::SerializedTransport() {
  Registry<SerializedTransport>::of_process().add(*this);
}

SerializedTransport::~SerializedTransport() {
  Registry<SerializedTransport>::of_process().remove(*this);
}

void SerializedTransport::enter() {
  static std::atomic<std::uint64_t> count = 0;
  packet_ = ++count;
}

void SerializedTransport::close() {
  const std::scoped_lock lock(mutex_);
  closed_ = true;
}

std::shared_ptr<transport::TransportDescriptorInterface> serialized(
    std::shared_ptr<transport::TransportDescriptorInterface> lower,
    SerializedTransport& serializer) {
  if constexpr (PREHEND_FAST_DDS != 2) return lower;
  return std::make_shared<SerializingDescriptor>(std::move(lower), serializer);
}

std::set<std::uint64_t> packets_in_process() {
  std::set<std::uint64_t> all;
  Registry<SerializedTransport>::of_process().for_each([&](const SerializedTransport& serializer) {
    if (const std::uint64_t packet = serializer.packet_; packet != 0) all.insert(packet);
  });
  return all;
}

bool DeadlockWatchdog::look() {
  std::map<std::uint64_t, int> now;
  bool deaf = false;
  for (const std::uint64_t packet : packets_in_process()) {
    const auto known = looks_.find(packet);
    now[packet] = known == looks_.end() ? 1 : known->second + 1;
    deaf = deaf || now[packet] >= max_looks;
  }
  looks_.swap(now);
  return deaf;
}

}  // namespace prehend::dds
