#include "services/console/core/roster.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

namespace prehend::console {
namespace {

/// A status comes once a second. So a killed service is told within 3 s of its end.
constexpr std::int64_t max_silence_ns = 2'900'000'000;
constexpr std::size_t max_left = 256;

}  // namespace

Roster::Service Roster::read(View message, const std::string& key, std::int64_t now_ns) {
  Service now{.name = message["name"].text(),
              .host = message["host"].text(),
              .state = message["state"].text(),
              .message = message["message"].text(),
              .latency = Json::array(),
              .heard_ns = now_ns};
  if (now.state.starts_with("STATE_")) now.state.erase(0, 6);
  std::transform(now.state.begin(), now.state.end(), now.state.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const View& drop : message["drops"].elements()) now.dropped += drop["count"].integer();
  for (const View& stage : message["latency"].elements())
    now.latency.push_back({{"service", key},
                           {"stage", stage["stage"].text()},
                           {"p50_ms", 1e-3 * stage["p50_us"].number()},
                           {"p99_ms", 1e-3 * stage["p99_us"].number()},
                           {"max_ms", 1e-3 * stage["max_us"].number()},
                           {"count", stage["count"].integer()}});
  return now;
}

Roster::News Roster::hear_status(View message, std::int64_t now_ns) {
  const std::string key = message["service"].text();
  Service now = read(message, key, now_ns);
  News news{.services = true};
  const auto before = services_.find(key);
  if (before == services_.end() || before->second.silent || before->second.state != now.state ||
      before->second.message != now.message)
    news.events.push_back({now.state == "degraded" ? LogLevel::warning : LogLevel::info, now.name,
                           now.message.empty() ? now.state : now.state + ": " + now.message});
  left_.erase(now.name);
  // Who was killed comes again as another process: nobody waits for the first any more.
  if (before == services_.end())
    std::erase_if(services_, [&](const auto& entry) {
      return entry.second.silent && entry.second.name == now.name;
    });
  services_[key] = std::move(now);
  return news;
}

Roster::News Roster::hear_gate(View message) {
  const std::string hand = message["hand"].text();
  const Gate now{message["leader"].text(),  message["stopped_by"].text(),
                 message["reason"].text(),  message["stopped"].flag(),
                 message["deadman"].flag(), message["consent"].flag()};
  News news{.gates = true};
  const auto before = gates_.find(hand);
  if (before == gates_.end() ? now.stopped : before->second.stopped != now.stopped)
    news.events.push_back({now.stopped ? LogLevel::error : LogLevel::info, hand,
                           now.stopped
                               ? fmt::format("stopped by {}: {}", now.stopped_by, now.reason)
                               : "released: " + now.reason});
  if (!now.leader.empty() && (before == gates_.end() || before->second.leader != now.leader))
    news.events.push_back({LogLevel::info, hand, now.leader + " leads"});
  gates_[hand] = now;
  return news;
}

Roster::News Roster::lose_status(View last) {
  const std::string service = last["service"].text(), name = last["name"].text();
  services_.erase(service);
  if (left_.size() < max_left) left_.insert(name);
  return {{{LogLevel::warning, name, service + " has left"}}, true, false};
}

Roster::News Roster::lose_gate(View last) {
  gates_.erase(last["hand"].text());
  return {.gates = true};
}

Roster::News Roster::wait(std::int64_t now_ns) {
  News news;
  for (auto& [key, service] : services_) {
    if (service.silent || now_ns - service.heard_ns <= max_silence_ns) continue;
    service.silent = news.services = true;
    news.events.push_back({LogLevel::error, service.name, key + " is silent"});
  }
  return news;
}

Json Roster::everybody() const {
  Json there = Json::array(), gates = Json::array();
  for (const auto& [key, service] : services_)
    if (!service.silent)
      there.push_back({{"service", key},
                       {"name", service.name},
                       {"host", service.host},
                       {"state", service.state},
                       {"message", service.message},
                       {"dropped", service.dropped}});
  for (const auto& [hand, gate] : gates_)
    gates.push_back({{"hand", hand},
                     {"leader", gate.leader},
                     {"stopped", gate.stopped},
                     {"stopped_by", gate.stopped_by},
                     {"reason", gate.reason},
                     {"deadman", gate.deadman},
                     {"consent", gate.consent}});
  return {{"services", there}, {"missing", missing()}, {"gates", gates}};
}

Json Roster::missing() const {
  Json all = Json::array();
  std::set<std::string> known;
  for (const auto& [key, service] : services_) {
    known.insert(service.name);
    if (service.silent)
      all.push_back({{"name", service.name},
                     {"reason", fmt::format("{} is silent for 3 s: killed, or cut off", key)}});
  }
  for (const std::string& name : wanted_)
    if (!known.contains(name))
      all.push_back(
          {{"name", name},
           {"reason", left_.contains(name) ? "has left" : "has not been heard since this began"}});
  return all;
}

Json Roster::latency() const {
  Json stages = Json::array();
  for (const auto& [key, service] : services_)
    for (const Json& stage : service.latency)
      if (!service.silent) stages.push_back(stage);
  return {{"stages", stages}};
}

}  // namespace prehend::console
