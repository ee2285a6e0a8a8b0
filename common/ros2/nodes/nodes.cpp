#include "common/ros2/nodes/nodes.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <string_view>

#include "common/base/log.hpp"
#include "common/ros2/nodes/type_hash.hpp"

namespace prehend::ros2 {
namespace {

constexpr int max_domain = 232;

}  // namespace

Expected<int> domain_of_nodes() {
  const char* said = std::getenv("ROS_DOMAIN_ID");
  const std::string_view text = said ? said : "";
  if (text.empty()) return 0;
  int domain = -1;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), domain);
  if (failed != std::errc{} || end != text.data() + text.size() || domain < 0 ||
      domain > max_domain)
    return wrong_use("is no domain", "ROS_DOMAIN_ID=" + std::string(text), "0 to 232");
  return domain;
}

Expected<std::string> network_of_nodes(const std::string& said) {
  if (said == "laptop" || said == "lan") return said;
  if (!said.empty()) return wrong_use("is neither laptop nor lan", "network " + said);
  const char* range = std::getenv("ROS_AUTOMATIC_DISCOVERY_RANGE");
  const std::string_view word = range ? range : "";
  if (word == "OFF")
    return wrong_use("lets no node be found", "ROS_AUTOMATIC_DISCOVERY_RANGE=OFF",
                     "SUBNET or LOCALHOST");
  return word == "SUBNET" ? "lan" : "laptop";
}

Expected<std::string> network_of_leaders(const std::string& said, bool secured) {
  auto network = network_of_nodes(said.empty() ? "laptop" : said);
  if (network && *network == "lan" && secured)
    return wrong_use("would let anybody on the network lead a hand that has keys", "ros.network",
                     "laptop: nodes of this machine alone");
  return network;
}

std::vector<std::string> hosts_of_nodes(const std::string& network) {
  const char* peers = std::getenv("ROS_STATIC_PEERS");
  std::vector<std::string> hosts;
  for (std::string_view rest = peers ? peers : ""; !rest.empty();) {
    const std::string_view host = rest.substr(0, rest.find(';'));
    if (!host.empty()) hosts.emplace_back(host);
    rest.remove_prefix(std::min(host.size() + 1, rest.size()));
  }
  if (hosts.empty() || network == "lan") return hosts;
  log::warning(
      "ROS_STATIC_PEERS has no effect: nodes of this machine alone are told; --network lan");
  return {};
}

Expected<dds::Participant> join_nodes(const std::string& name, int domain,
                                      const std::string& network,
                                      const std::vector<std::string>& hosts) {
  dds::ParticipantOptions options{.name = name, .domain = domain};
  options.network.profile = network;
  options.network.hosts = hosts;
  return dds::Participant::create(options);
}

dds::RawTopic topic_of_nodes(const std::string& name, const std::string& type, bool kept) {
  const auto slash = type.find('/');
  dds::RawTopic topic{"rt/" + name,
                      type.substr(0, slash) + "::msg::dds_::" + type.substr(slash + 1) + "_",
                      false,
                      {}};
  topic.qos.transient_local = kept;
  topic.qos.writer_depth = kept ? 1 : 10;
  topic.qos.user_data = announced_hash(type);
  return topic;
}

}  // namespace prehend::ros2
