#include "gate.hpp"

#include "passing_transport.hpp"

namespace prehend::dds {

namespace transport = eprosima::fastdds::rtps;
namespace rtps = eprosima::fastrtps::rtps;

namespace {

struct Gates {
  std::mutex mutex;
  std::set<const Gate*> all;
};
Gates& gates() {
  static auto* instance = new Gates;  // outlives the threads that receive
  return *instance;
}

/// Ports of samples are odd, those of discovery even (RTPS 2.2, 9.6.1.1).
bool carries_samples(const rtps::Locator_t& local) {
  return local.kind == LOCATOR_KIND_UDPv4 && local.port % 2 == 1;
}

class Transport final : public PassingTransport {
 public:
  Transport(const transport::ChainingTransportDescriptor& descriptor, Gate& gate)
      : PassingTransport(descriptor), gate_(gate) {}
  void receive(transport::TransportReceiverInterface* next, const rtps::octet* bytes,
               std::uint32_t size, const rtps::Locator_t& local,
               const rtps::Locator_t& remote) override {
    const auto process = [&] { next->OnDataReceived(bytes, size, local, remote); };
    if (carries_samples(local))
      process();
    else
      gate_.pass(process);
  }

 private:
  Gate& gate_;
};

struct Descriptor final : transport::ChainingTransportDescriptor {
  Descriptor(std::shared_ptr<transport::TransportDescriptorInterface> lower, Gate& one)
      : ChainingTransportDescriptor(std::move(lower)), gate(one) {}
  transport::TransportInterface* create_transport() const override {
    return new Transport(*this, gate);
  }
  Gate& gate;
};

}  // namespace

Gate::Gate() {
  const std::scoped_lock lock(gates().mutex);
  gates().all.insert(this);
}

Gate::~Gate() {
  const std::scoped_lock lock(gates().mutex);
  gates().all.erase(this);
}

void Gate::enter() {
  static std::atomic<std::uint64_t> count = 0;
  packet_ = ++count;
}

void Gate::close() {
  const std::scoped_lock lock(mutex_);
  closed_ = true;
}

std::shared_ptr<transport::TransportDescriptorInterface> gated(
    std::shared_ptr<transport::TransportDescriptorInterface> lower, Gate& gate) {
  return std::make_shared<Descriptor>(std::move(lower), gate);
}

std::set<std::uint64_t> packets_in_hand() {
  const std::scoped_lock lock(gates().mutex);
  std::set<std::uint64_t> all;
  for (const Gate* gate : gates().all)
    if (const std::uint64_t packet = gate->packet_; packet != 0) all.insert(packet);
  return all;
}

bool DeafnessWatch::look() {
  std::map<std::uint64_t, int> now;
  bool deaf = false;
  for (const std::uint64_t packet : packets_in_hand()) {
    const auto known = looks_.find(packet);
    now[packet] = known == looks_.end() ? 1 : known->second + 1;
    deaf = deaf || now[packet] >= most;
  }
  looks_.swap(now);
  return deaf;
}

}  // namespace prehend::dds
