#include "common/dds/guard/wan_transport.hpp"

#include <linux/tcp.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <vector>

#include "common/dds/guard/pass_through_transport.hpp"

namespace prehend::dds {
namespace {

using rtps::IPLocator;

/// A connection that works carries two announcements a second. One over which nothing has been said
/// for so long, and not more received than a greeting, has missed it.
constexpr std::chrono::milliseconds max_pause{1200};
constexpr std::uint64_t max_greeting = 4096;  // bytes, that of TLS as well
constexpr std::uint8_t established = 1;       // the kernel's TCP_ESTABLISHED

Ipv4 ip_at(const void* bytes) {
  Ipv4 ip;
  std::copy_n(static_cast<const std::uint8_t*>(bytes), ip.size(), ip.begin());
  return ip;
}

/// Cuts connections to these places that have stopped at the greeting.
void cut_silent(const Dialled& dialled) {
  std::error_code code;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", code)) {
    const int file = std::atoi(entry.path().filename().c_str());
    sockaddr_in peer{};
    socklen_t size = sizeof peer;
    if (::getpeername(file, reinterpret_cast<sockaddr*>(&peer), &size) != 0 ||
        peer.sin_family != AF_INET ||
        !dialled.contains({ip_at(&peer.sin_addr), ntohs(peer.sin_port)}))
      continue;
    tcp_info info{};
    size = sizeof info;
    if (::getsockopt(file, IPPROTO_TCP, TCP_INFO, &info, &size) == 0 &&
        info.tcpi_state == established && info.tcpi_bytes_received < max_greeting &&
        info.tcpi_last_data_sent > max_pause.count())
      ::shutdown(file, SHUT_RDWR);
  }
}

class WanTransport final : public PassThroughTransport {
 public:
  WanTransport(const transport::ChainingTransportDescriptor& descriptor, Dialled dialled)
      : PassThroughTransport(descriptor), dialled_(std::move(dialled)) {
    if (dialled_.empty() || PREHEND_FAST_DDS != 2) return;
    watch_ = std::jthread([this](const std::stop_token& end) {
      std::mutex mutex;
      std::unique_lock lock(mutex);
      std::condition_variable_any ended;
      while (!ended.wait_for(lock, end, max_pause, [&] { return end.stop_requested(); }))
        cut_silent(dialled_);
    });
  }
  bool transform_remote_locator(const rtps::Locator_t& remote,
                                rtps::Locator_t& result) const override {
    const auto found = way(remote);
    if (found) result = *found;
    return found.has_value();
  }
#if PREHEND_FAST_DDS > 2  // asks by this one, and not for who is on another host
  bool transform_remote_locator(const rtps::Locator_t& remote, rtps::Locator_t& result, bool,
                                bool) const override {
    return transform_remote_locator(remote, result);
  }
#endif
  bool OpenOutputChannel(transport::SendResourceList& senders,
                         const rtps::Locator_t& remote) override {
    const auto found = way(remote);
    return found && open_wrapped(senders, *found);
  }
  bool send(rtps::SenderResource* lower, Bytes bytes, std::uint32_t size,
            rtps::LocatorsIterator* begin, rtps::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& timeout) override {
    std::vector<rtps::Locator_t> ways;
    for (; *begin != *end; ++*begin)
      if (const auto found = way(**begin); found && std::ranges::count(ways, *found) == 0)
        ways.push_back(*found);
    rtps::Locators first(ways.cbegin()), last(ways.cend());
    return PassThroughTransport::send(lower, bytes, size, &first, &last, timeout);
  }

 private:
  /// The locator by which a remote one is reached; nothing: not by TCP.
  std::optional<rtps::Locator_t> way(const rtps::Locator_t& remote) const {
    if (remote.kind != LOCATOR_KIND_TCPv4) return std::nullopt;
    // Who dials has made the connection itself.
    if (dialled_.empty())
      return IPLocator::getLogicalPort(remote) == dials ? std::optional(remote) : std::nullopt;
    const Ipv4 ip =
        ip_at(IPLocator::hasWan(remote) ? IPLocator::getWan(remote) : IPLocator::getIPv4(remote));
    if (!dialled_.contains({ip, IPLocator::getPhysicalPort(remote)})) return std::nullopt;
    rtps::Locator_t there;
    there.kind = LOCATOR_KIND_TCPv4;
    there.set_Invalid_Address();
    IPLocator::setIPv4(there, ip.data());
    there.port = remote.port;
    return there;
  }

  Dialled dialled_;
  std::jthread watch_;
};

struct WanTransportDescriptor final : transport::ChainingTransportDescriptor {
  WanTransportDescriptor(std::shared_ptr<transport::TransportDescriptorInterface> lower,
                         Dialled dialled, std::shared_ptr<const void> what_others_come_to)
      : ChainingTransportDescriptor(std::move(lower)),
        dialled_(std::move(dialled)),
        door_(std::move(what_others_come_to)) {}
  transport::TransportInterface* create_transport() const override {
    return new WanTransport(*this, dialled_);
  }
  Dialled dialled_;
  std::shared_ptr<const void> door_;
};

}  // namespace

std::shared_ptr<transport::TransportDescriptorInterface> wan_transport(
    std::shared_ptr<transport::TransportDescriptorInterface> tcp, Dialled dialled,
    std::shared_ptr<const void> keeps) {
  return std::make_shared<WanTransportDescriptor>(std::move(tcp), std::move(dialled),
                                                  std::move(keeps));
}

}  // namespace prehend::dds
