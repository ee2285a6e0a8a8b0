#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "common/service/config.hpp"

namespace prehend::console {

/// Datagrams to a glove's device `landmarks`.
class GloveLine {
 public:
  /// To where the configuration has that device. Fails where the glove is another one.
  static Expected<std::unique_ptr<GloveLine>> create(const service::Config& config);
  ~GloveLine();
  GloveLine(const GloveLine&) = delete;
  GloveLine& operator=(const GloveLine&) = delete;

  /// To nobody, perhaps: then the glove's status says that nothing comes.
  void send(std::string_view line) const;

 private:
  GloveLine(int socket, std::string token) : socket_(socket), token_(std::move(token)) {}
  int socket_;
  std::string token_;
};

}  // namespace prehend::console
