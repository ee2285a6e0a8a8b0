#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/stage/process.hpp"

namespace prehend::integration {

/// How far away a host is.
struct Distance {
  double delay_ms = 0, jitter_ms = 0;  // each way; the jitter is uniform to both sides
};

/// What has passed a bridge since it was made.
struct Traffic {
  std::uint64_t sent_packets = 0, sent_bytes = 0;    // by the hosts
  std::uint64_t heard_packets = 0, heard_bytes = 0;  // delivered to hosts: multicast to each
};

/// Several hosts on one machine: network and host name spaces, joined by a bridge in a space of its
/// own, so that neither the machine's network nor its packet filter is touched and nothing is left
/// behind, however the test ends. Needs root.
class Hosts {
 public:
  /// nullopt when spaces can be made; else why not, for a skip.
  static std::optional<std::string> unavailable();

  /// way: the program prehend-delay-line, for hosts that are far away.
  explicit Hosts(std::string way = {});
  ~Hosts();

  /// Joins a host with an address of its own.
  void add(const std::string& name, const Distance& distance = {});
  std::string address(const std::string& name) const;

  /// A command line that runs a command on the host.
  std::vector<std::string> on(const std::string& host, std::vector<std::string> command) const;
  /// Moves this thread, and those that it will start, to the host. The destructor moves it back.
  void enter(const std::string& host);

  /// The same without a way back, for a thread that ends there.
  void enter_for_good(const std::string& host) const;

  /// From now on `host` hears nothing of `other`.
  void refuse(const std::string& host, const std::string& other);
  /// The cable.
  void link(const std::string& host, bool up);
  /// Part of the packets that are dropped on their way to and from the host; 0: none.
  void lose(const std::string& host, double share);
  Traffic traffic() const;

 private:
  struct Host {
    std::string name;
    int number;
    stage::Process keeper;
    std::optional<stage::Process> delay_line;
  };
  const Host& host(const std::string& name) const;
  std::vector<std::string> bridge(std::vector<std::string> command) const;

  std::string way_;
  std::vector<std::unique_ptr<Host>> hosts_;
  std::optional<stage::Process> bridge_;
  int home_ = -1;  // this thread's space before enter()
};

}  // namespace prehend::integration
