#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "common/base/time.hpp"
#include "common/dds/packet.hpp"

namespace prehend::dds {

/// Decides which connections to a listening site stop in their handshake of TLS. Fast DDS, 2.9.1 as
/// 3.1.2, makes one handshake at a time and waits for its end without a limit, so one connection
/// that says nothing keeps everybody else out. Who has said nothing new for a while, or has not
/// come to its end in time, is to be cut. Where several were, the next ones get less time, so that
/// a hundred of them are gone in half a minute; it is still more than a way there and back. Pure:
/// connections and times are told. Bounded.
class GreetingWatch {
 public:
  struct Connection {
    int file = 0;
    Ipv4 address{};
    std::uint16_t port = 0;      // there
    std::uint64_t received = 0;  // bytes
  };
  /// open: all that were accepted. Returns the files of those that are to be cut now.
  std::vector<int> judge(const std::vector<Connection>& open, Time now);

  std::size_t known_addresses() const { return cuts_.size(); }
  static constexpr Duration patience = std::chrono::milliseconds(1000),
                            short_patience = std::chrono::milliseconds(250),
                            max_greeting_time = std::chrono::seconds(5),
                            memory = std::chrono::seconds(60);
  static constexpr int max_cuts = 3;  // of one address, with patience
  /// Bytes. A handshake and the first announcements are more.
  static constexpr std::uint64_t max_greeting = 4096;
  static constexpr std::size_t max_addresses = 1024;

 private:
  struct Seen {
    Connection connection;
    Time first{}, changed{};
  };
  struct Cuts {
    int count = 0;
    Time last{};
  };
  Duration patience_with(const Ipv4& address, Time now) const;
  void note_cut(const Ipv4& address, Time now);

  std::map<int, Seen> seen_;
  std::map<Ipv4, Cuts> cuts_;
};

}  // namespace prehend::dds
