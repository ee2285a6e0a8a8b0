#include "common/dds/guard/guarded_transport.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/clock.hpp"
#include "common/dds/guard/early_handshakes.hpp"
#include "common/dds/guard/pass_through_transport.hpp"
#include "common/dds/guard/registry.hpp"
#include "common/dds/guard/rtps_parts.hpp"

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

void add(PacketVerdict reason, const Ipv4& source, std::uint64_t times = 1) {
  const std::scoped_lock lock(count().mutex);
  Dropped& dropped = count().dropped[static_cast<std::size_t>(reason)];
  dropped.reason = reason;
  dropped.count += times;
  dropped.last_source = fmt::format("{}", fmt::join(source, "."));
}

/// A message as it lies on the wire.
#if PREHEND_FAST_DDS == 2
std::span<const std::uint8_t> whole(const rtps::octet* bytes, std::uint32_t size) {
  return {bytes, size};
}
#else
std::vector<std::uint8_t> whole(const std::vector<transport::NetworkBuffer>& pieces,
                                std::uint32_t size) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(size);
  for (const auto& piece : pieces) {
    const auto* begin = static_cast<const std::uint8_t*>(piece.buffer);
    bytes.insert(bytes.end(), begin, begin + piece.size);
  }
  return bytes;
}
#endif

class Transport final : public PassThroughTransport {
 public:
  Transport(const transport::ChainingTransportDescriptor& descriptor, PacketGuard& guard)
      : PassThroughTransport(descriptor), guard_(guard) {}
  bool OpenOutputChannel(transport::SendResourceList& senders,
                         const rtps::Locator_t& remote) override {
    if (guard_.paces()) return open_wrapped(senders, remote);
    return PassThroughTransport::OpenOutputChannel(senders, remote);
  }
  bool send(rtps::SenderResource* lower, Bytes bytes, std::uint32_t size,
            rtps::LocatorsIterator* begin, rtps::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& timeout) override {
    if (!guard_.paces() || *begin == *end || carries_samples(**begin))
      return lower->send(bytes, size, begin, end, timeout);
    const auto said = repeated_saying(whole(bytes, size));
    if (!said) return lower->send(bytes, size, begin, end, timeout);
    std::vector<rtps::Locator_t> due;
    for (; *begin != *end; ++*begin)
      if (guard_.may_say({ip_of(**begin), static_cast<std::uint16_t>((**begin).port)}, lower,
                         *said))
        due.push_back(**begin);
    if (due.empty()) return true;
    rtps::Locators first(due.cbegin()), last(due.cend());
    return lower->send(bytes, size, &first, &last, timeout);
  }
  void receive(transport::TransportReceiverInterface* next, const rtps::octet* bytes,
               std::uint32_t size, const rtps::Locator_t& local,
               const rtps::Locator_t& remote) override {
    const Ipv4 source =
        low_level_transport_->is_local_locator(remote) ? Ipv4{127, 0, 0, 1} : ip_of(remote);
    const bool accepted = guard_.accepts({bytes, size}, source);
    if (accepted) next->OnDataReceived(bytes, size, local, remote);
    if (const auto early = early_handshake({bytes, size}, accepted))
      if (guard_.accepts(*early, source))
        next->OnDataReceived(early->data(), static_cast<std::uint32_t>(early->size()), local,
                             remote);
    if (carries_samples(local)) return;
    for (const auto& late : guard_.take_departures())
      next->OnDataReceived(late.data(), static_cast<std::uint32_t>(late.size()), local, remote);
  }

 private:
  /// What was kept of a sender that is admitted with this packet.
  std::optional<std::vector<std::uint8_t>> early_handshake(std::span<const std::uint8_t> message,
                                                           bool accepted) {
    constexpr std::size_t header = 20;
    if (message.size() < header) return std::nullopt;
    const GuidPrefix sender = wire::array_at<12>(message, 8);
    const bool keeps = !accepted && read_packet(message) && read_plaintext(message).shakes_hands;
    const std::scoped_lock lock(mutex_);
    if (keeps) early_.keep(sender, message, process_now());
    if (!accepted || early_.empty()) return std::nullopt;
    return early_.take(sender, process_now());
  }

  PacketGuard& guard_;
  std::mutex mutex_;
  EarlyHandshakes early_;
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

PacketGuard::PacketGuard(bool serves, bool secured, bool paces, Hear hear)
    : book_(serves, secured), members_(secured), hear_(std::move(hear)), paces_(paces) {
  Registry<PacketGuard>::of_process().add(*this);
}

PacketGuard::~PacketGuard() {
  Registry<PacketGuard>::of_process().remove(*this);
}

PacketVerdict PacketGuard::judge(std::span<const std::uint8_t> message, const Ipv4& source,
                                 std::vector<Announcement>& told) {
  const Time now = process_now();
  const PacketVerdict verdict = book_.judge(message, source, now, &told);
  if (verdict != PacketVerdict::pass) return verdict;
  switch (members_.judge(wire::array_at<12>(message, 8), message, now, !told.empty())) {
    case Members::Verdict::not_encrypted:
      return PacketVerdict::not_encrypted;
    case Members::Verdict::contradicts:
      return PacketVerdict::contradicts;
    case Members::Verdict::keep:
      return PacketVerdict::kept;
    case Members::Verdict::pass:
      break;
  }
  return PacketVerdict::pass;
}

bool PacketGuard::accepts(std::span<const std::uint8_t> message, const Ipv4& source) {
  PacketVerdict verdict;
  std::uint64_t forged;
  std::vector<Announcement> told;
  {
    const std::scoped_lock lock(mutex_);
    verdict = judge(message, source, told);
    forged = members_.take_forged();
  }
  if (verdict == PacketVerdict::pass && !told.empty()) hear(message, told);
  if (forged > 0) add(PacketVerdict::forged_departure, source, forged);
  if (!verdict_names[static_cast<std::size_t>(verdict)].empty()) add(verdict, source);
  return verdict == PacketVerdict::pass;
}

void PacketGuard::hear(std::span<const std::uint8_t> message,
                       const std::vector<Announcement>& told) {
  if (paces_) {
    const auto sender = wire::array_at<12>(message, 8);
    const std::scoped_lock lock(pacing_);
    for (const Place& place : announced_places(message)) pacer_.met(place, sender);
  }
  if (!hear_) return;
  for (const Announcement& one : told) hear_(one);
}

bool PacketGuard::may_say(const Place& to, const void* way, const Saying& what) {
  const std::scoped_lock lock(pacing_);
  return pacer_.is_due(to, way, what, process_now());
}

std::vector<std::vector<std::uint8_t>> PacketGuard::take_departures() {
  const std::scoped_lock lock(mutex_);
  return members_.take_departures(process_now());
}

void PacketGuard::let_in(const GuidPrefix& peer) {
  const std::scoped_lock lock(mutex_);
  book_.let_in(peer);
  members_.let_in(peer);
}

void PacketGuard::lost(const GuidPrefix& peer) {
  const std::scoped_lock lock(mutex_);
  members_.lost(peer);
}

bool PacketGuard::shook_hands(const GuidPrefix& peer) const {
  const std::scoped_lock lock(mutex_);
  return members_.shook_hands(peer);
}

bool PacketGuard::is_stranded() const {
  const std::scoped_lock lock(mutex_);
  return members_.is_stranded(process_now());
}

bool anybody_stranded() {
  bool any = false;
  Registry<PacketGuard>::of_process().for_each(
      [&](const PacketGuard& guard) { any |= guard.is_stranded(); });
  return any;
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
