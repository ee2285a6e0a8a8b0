#include "common/dds/guarded_transport.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/clock.hpp"
#include "common/dds/pass_through_transport.hpp"

namespace prehend::dds {

namespace {

struct Count {
  std::mutex mutex;
  std::array<Dropped, verdict_names.size()> dropped;
};
Count& count() {
  static auto* instance = new Count;  // outlives the threads that receive
  return *instance;
}

void add(PacketVerdict reason, const Ipv4& source) {
  const std::scoped_lock lock(count().mutex);
  Dropped& dropped = count().dropped[static_cast<std::size_t>(reason)];
  dropped.reason = reason;
  ++dropped.count;
  dropped.last_source = fmt::format("{}", fmt::join(source, "."));
}

class Transport final : public PassThroughTransport {
 public:
  Transport(const transport::ChainingTransportDescriptor& descriptor, PacketGuard& guard)
      : PassThroughTransport(descriptor), guard_(guard) {}
  void receive(transport::TransportReceiverInterface* next, const rtps::octet* bytes,
               std::uint32_t size, const rtps::Locator_t& local,
               const rtps::Locator_t& remote) override {
    const Ipv4 source =
        low_level_transport_->is_local_locator(remote) ? Ipv4{127, 0, 0, 1} : ip_of(remote);
    if (guard_.accepts({bytes, size}, source)) next->OnDataReceived(bytes, size, local, remote);
  }

 private:
  PacketGuard& guard_;
};

struct Descriptor final : transport::ChainingTransportDescriptor {
  Descriptor(std::shared_ptr<transport::TransportDescriptorInterface> lower, PacketGuard& judge)
      : ChainingTransportDescriptor(std::move(lower)), guard(judge) {}
  transport::TransportInterface* create_transport() const override {
    return new Transport(*this, guard);
  }
  PacketGuard& guard;
};

}  // namespace

Ipv4 ip_of(const rtps::Locator_t& locator) {
  Ipv4 address;
  std::copy_n(locator.address + 12, address.size(), address.begin());
  return address;
}

bool PacketGuard::accepts(std::span<const std::uint8_t> message, const Ipv4& source) {
  PacketVerdict verdict;
  std::vector<Announcement> told;
  {
    const std::scoped_lock lock(mutex_);
    verdict = book_.judge(message, source, process_now(), hear_ ? &told : nullptr);
  }
  for (const Announcement& one : told) hear_(one);
  if (verdict != PacketVerdict::pass) add(verdict, source);
  return verdict == PacketVerdict::pass;
}

void PacketGuard::add_own(const GuidPrefix& own) {
  const std::scoped_lock lock(mutex_);
  book_.add_own(own);
}

void PacketGuard::add_server(const GuidPrefix& server, const Ipv4& address) {
  const std::scoped_lock lock(mutex_);
  book_.add_server(server, address);
}

std::shared_ptr<transport::TransportDescriptorInterface> guarded(
    std::shared_ptr<transport::TransportDescriptorInterface> lower, PacketGuard& guard) {
  return std::make_shared<Descriptor>(std::move(lower), guard);
}

std::vector<Dropped> dropped_packets() {
  const std::scoped_lock lock(count().mutex);
  std::vector<Dropped> all;
  for (const Dropped& one : count().dropped)
    if (one.count > 0) all.push_back(one);
  return all;
}

}  // namespace prehend::dds
