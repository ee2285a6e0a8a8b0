#include "services/cli/tools/doctor/neighbours.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include "common/base/printable.hpp"
#include "common/dds/discovery_events.hpp"
#include "common/dds/participant.hpp"
#include "common/dds/release/user_data.hpp"
#include "common/service/membership.hpp"
#include "services/cli/tools/doctor/leading.hpp"
#include "services/cli/tools/doctor/wire.hpp"

namespace prehend::cli {

namespace rtps = dds::rtps;

namespace {

/// Beyond this, frames of one host look stale on another.
constexpr Duration clock_tolerance = std::chrono::milliseconds(50);
/// Everybody has announced itself twice.
constexpr Duration enough = std::chrono::milliseconds(1200);

/// The types of our topics, as they are called in discovery.
std::map<std::string, std::string> contract_types() {
  std::map<std::string, std::string> types;
  for (const dds::TopicInfo& topic : dds::topic_table) types.emplace(topic.name, topic.type_name());
  return types;
}

/// Everything that discovery tells, in its threads.
class DiscoveryListener : public dds::DiscoveryEvents {
 public:
  struct Endpoint {
    std::string topic, type;
    bool writes = false;
    std::vector<std::string> rigs;
  };
  std::mutex mutex;
  std::set<rtps::GuidPrefix_t> peers;
  std::vector<Endpoint> endpoints;

  void on_participant(const dds::FoundParticipant& found) override {
    if (found.news != dds::News::found) return;
    const std::scoped_lock lock(mutex);
    peers.insert(found.guid.guidPrefix);
  }
  void on_endpoint(const dds::FoundEndpoint& found) override {
    if (found.news != dds::News::found) return;
    const std::scoped_lock lock(mutex);
    endpoints.push_back({found.topic, found.type, found.writes, found.rigs});
  }
};

Check judge_types(const std::vector<DiscoveryListener::Endpoint>& endpoints) {
  static const auto types = contract_types();
  std::set<std::string> strange;
  for (const DiscoveryListener::Endpoint& endpoint : endpoints)
    if (const auto due = types.find(endpoint.topic);
        due != types.end() && due->second != endpoint.type)
      strange.insert(fmt::format("{} as {}, not {}", endpoint.topic, endpoint.type, due->second));
  if (strange.empty()) return {"types", true, "all topics have the types of this version", ""};
  return {"types", false, fmt::format("somebody has {}", fmt::join(strange, "; ")),
          "install the same version of Prehend everywhere"};
}

Check judge_rig(const std::string& own, const std::vector<DiscoveryListener::Endpoint>& endpoints) {
  std::set<std::string> others;
  bool here = false;
  for (const DiscoveryListener::Endpoint& endpoint : endpoints)
    if (endpoint.writes && endpoint.topic == dds::service_status.name)
      for (const std::string& rig : endpoint.rigs) {
        here = here || rig == own;
        if (rig != own) others.insert(rig);
      }
  if (here) return {"rig", true, fmt::format("services are in the rig {}", own), ""};
  if (others.empty()) return {"rig", true, "no services are in this domain", ""};
  return {"rig", false,
          fmt::format("nobody is in the rig {}; services are in {}", own, fmt::join(others, ", ")),
          "set lab.rig alike everywhere"};
}

Check judge_domain(int own, const std::map<int, int>& heard, bool alone) {
  std::vector<int> others;
  for (const auto& [domain, count] : heard)
    if (domain != own) others.push_back(domain);
  if (!alone) return {"domain", true, fmt::format("others are in domain {}", own), ""};
  if (others.empty()) return {"domain", true, "nobody announces itself in any domain", ""};
  return {"domain", false,
          fmt::format("nobody is in domain {}; participants announce themselves in {}", own,
                      fmt::join(others, ", ")),
          "set lab.domain alike everywhere"};
}

/// Both releases of Fast DDS understand each other, but not where there are keys.
Check judge_middleware(const dds::Participant& participant) {
  std::map<std::string, std::vector<std::string>> by_release;
  for (const auto& [prefix, peer] : participant.present())
    if (prefix != participant.identity() && !peer.middleware.empty())
      by_release[peer.middleware].push_back(printable(peer.name));
  std::string text = fmt::format("this process has {}", dds::own_middleware);
  for (auto& [release, names] : by_release) {
    std::ranges::sort(names);
    names.erase(std::unique(names.begin(), names.end()), names.end());
    text += fmt::format("; {} {} {}", fmt::join(names, ", "), names.size() == 1 ? "has" : "have",
                        release);
  }
  return {"dds", true, text, ""};
}

Check judge_security(const dds::Participant& participant) {
  std::vector<std::string> refused;
  for (const auto& [peer, count] : participant.refused()) refused.push_back(peer);
  if (refused.empty()) return {"security", true, "no peer was refused", ""};
  return {
      "security", false, fmt::format("not heard here: {}", fmt::join(refused, "; ")),
      "give every process keys of one keystore in lab.keys, or none (prehend keys show), and one "
      "release of Debian to a secured lab"};
}

/// Smallest difference between a host's stamp and its arrival here, by host.
Check judge_clocks(const std::map<std::string, Duration>& offsets) {
  std::string wrong;
  for (const auto& [host, offset] : offsets)
    if (std::chrono::abs(offset) > clock_tolerance)
      (wrong += wrong.empty() ? "" : "; ") +=
          fmt::format("{} is {:.3f} s {}", host, std::abs(to_seconds(offset)),
                      offset > Duration::zero() ? "behind" : "ahead");
  if (wrong.empty()) return {"clocks", true, fmt::format("{} hosts agree", offsets.size()), ""};
  return {"clocks", false, wrong, "run chrony or systemd-timesyncd on every host"};
}

}  // namespace

Expected<Findings> check_neighbours(const service::Config& config, Duration listen) {
  dds::ParticipantOptions lab = service::membership(config, "doctor", "viewer");
  const std::string network = lab.network.profile;
  // Before joining, so that what is heard is of others.
  const bool multicast = network == "laptop" || network == "lan";
  const auto heard =
      multicast ? heard_domains(config, std::min<Duration>(listen, enough)) : std::map<int, int>();
  DiscoveryListener discovered;
  lab.listener = &discovered;
  auto participant = dds::Participant::create(lab);
  if (!participant) return tl::unexpected(participant.error());
  auto statuses = participant->reader(dds::service_status);
  if (!statuses) return tl::unexpected(statuses.error());

  auto leading = Leading::create(*participant);
  if (!leading) return tl::unexpected(leading.error());

  std::map<std::string, Duration> offsets;
  std::set<std::string> known;  // the first status of a service may be as old as its last second
  const auto end = std::chrono::steady_clock::now() + listen;
  while (std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    leading->hear();
    const Time now = std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
    for (const auto& sample : statuses->take()) {
      if (sample.info.gone || known.insert(sample.data.service().to_string()).second) continue;
      const Duration late = now - sample.info.sent;
      const auto [found, fresh] = offsets.try_emplace(sample.data.host().to_string(), late);
      if (!fresh && std::chrono::abs(late) < std::chrono::abs(found->second)) found->second = late;
    }
  }

  const std::scoped_lock lock(discovered.mutex);
  Findings findings;
  if (network == "server") {
    const bool found = std::ranges::any_of(discovered.peers,
                                           [](const auto& peer) { return dds::is_server(peer); });
    findings.push_back(
        found ? Check{"discovery server", true, "answers", ""}
              : Check{"discovery server", false,
                      fmt::format("none of {} answers", fmt::join(lab.network.servers, ", ")),
                      "start `prehend discovery-server` there, and let UDP through to its port"});
  } else {
    findings.push_back(judge_domain(lab.domain, heard, discovered.peers.empty()));
  }
  findings.push_back(judge_rig(lab.rig, discovered.endpoints));
  findings.push_back(judge_types(discovered.endpoints));
  findings.push_back(judge_middleware(*participant));
  findings.push_back(judge_security(*participant));
  findings.push_back(judge_clocks(offsets));
  findings.push_back(leading->judge());
  return findings;
}

}  // namespace prehend::cli
