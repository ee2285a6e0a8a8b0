#include "common/service/instance.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <functional>
#include <map>

namespace prehend::service {

std::string instance_of(const Config& config, std::string_view service) {
  static const std::map<std::string, std::string, std::less<>> by_hand{
      {"glove", "glove.name"}, {"mapping", "mapping.hand_name"}, {"robot", "robot.hand_name"}};
  const auto key = by_hand.find(service);
  return key == by_hand.end() ? "" : config.text(key->second);
}

std::string status_key(std::string_view service, std::string_view host, std::string_view instance) {
  return fmt::format("{}@{}/{}{}{}", service, host, instance.substr(0, 32),
                     instance.empty() ? "" : "/", ::getpid());
}

std::string instance_in(std::string_view key) {
  const std::size_t host = key.find('@');
  const std::size_t first = host == key.npos ? key.npos : key.find('/', host);
  const std::size_t last = key.rfind('/');
  if (first == key.npos || first == last) return "";
  return std::string(key.substr(first + 1, last - first - 1));
}

}  // namespace prehend::service
