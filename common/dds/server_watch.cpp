#include "common/dds/server_watch.hpp"

#include <arpa/inet.h>

#include <algorithm>

namespace prehend::dds {

ServerWatch::ServerWatch(const std::vector<std::string>& servers,
                         std::function<void(const Address&)> is_at)
    : is_at_(std::move(is_at)) {
  std::copy_if(servers.begin(), servers.end(), std::back_inserter(names_), [](const auto& text) {
    in_addr number{};
    return ::inet_pton(AF_INET, text.substr(0, text.rfind(':')).c_str(), &number) != 1;
  });
  if (!names_.empty()) thread_ = std::jthread([this](const std::stop_token& stop) { watch(stop); });
}

void ServerWatch::watch(const std::stop_token& stop) {
  while (true) {
    {
      std::unique_lock lock(mutex_);
      wake_.wait_for(lock, stop, std::chrono::seconds(2), [] { return false; });
      if (stop.stop_requested()) return;
    }
    for (const std::string& name : names_)
      if (const auto address = resolve(name, first_server_port)) is_at_(*address);
  }
}

}  // namespace prehend::dds
