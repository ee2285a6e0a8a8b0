#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "common/base/error.hpp"

namespace prehend::dds {

/// Stands before the TLS port of Fast DDS (2.9 and 3.1), which shakes hands with one at a time and
/// waits for it without end: one connection that says nothing keeps all others out. The front
/// shakes hands with all who come at once, each within a time limit, and passes on only who has
/// keys of the lab that are not revoked. Towards Fast DDS, which listens on the loopback alone, it
/// is a peer with the keys of this process.
class TlsFront {
 public:
  struct Options {
    std::uint16_t port = 0;   // of all interfaces, where others come
    std::uint16_t inner = 0;  // of 127.0.0.1, where Fast DDS listens
    // Files in PEM: the keys of this process, who vouches for those of the lab, and which of these
    // are revoked.
    std::filesystem::path certificate, key, authority, revoked;
  };
  static Expected<std::unique_ptr<TlsFront>> create(const Options& options);
  ~TlsFront();

 private:
  class Loop;
  explicit TlsFront(std::unique_ptr<Loop> loop);
  std::unique_ptr<Loop> loop_;
};

/// A port of the loopback at which nobody listens; 0: there is none.
std::uint16_t free_inner_port();

}  // namespace prehend::dds
