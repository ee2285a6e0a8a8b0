#include "services/cli/tools/status/status_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "common/base/printable.hpp"
#include "common/service/instance.hpp"
#include "common/service/status.hpp"

namespace prehend::cli {
namespace {

constexpr Duration max_silence = std::chrono::seconds(3);  // a status comes once a second
constexpr Duration forgotten = std::chrono::seconds(60);   // what is gone
constexpr std::size_t max_services = 1000;

std::string_view to_string(v1::ServiceState state) {
  return service::state_names.name(state, "starting");
}

std::string age(double s) {
  if (s < 120) return fmt::format("{:.0f} s", s);
  if (s < 7200) return fmt::format("{:.0f} min", s / 60);
  return fmt::format("{:.1f} h", s / 3600);
}

std::string latency(double us) {
  return us < 10'000 ? fmt::format("{:.0f} µs", us) : fmt::format("{:.1f} ms", us / 1000);
}

/// What a service says of itself.
template <class Text>
std::string shown(const Text& text) {
  return printable(text.to_string());
}

/// Right-aligned by what is seen: «µ» and «±» are two bytes each.
std::string right(const std::string& text, std::size_t width) {
  const auto seen = static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
  return std::string(width > seen ? width - seen : 0, ' ') + text;
}

}  // namespace

void StatusView::hear(const v1::ServiceStatus& status, Time now, const std::string& middleware) {
  std::erase_if(services_, [&](const auto& entry) { return now - entry.second.heard > forgotten; });
  const std::string key = status.service().to_string();
  if (!services_.contains(key) && services_.size() >= max_services) return;
  Service& service = services_[key];
  std::map<std::string, std::uint64_t> before;
  for (const v1::Drop& drop : service.status.drops())
    before[drop.reason().to_string()] = drop.count();
  service.fresh_drops.clear();
  for (const v1::Drop& drop : status.drops()) {
    const std::string reason = drop.reason().to_string();
    if (service.heard != Time{} && drop.count() > before[reason])
      service.fresh_drops[reason] = drop.count() - before[reason];
  }
  service.status = status;
  service.heard = now;
  service.gone = false;
  if (!middleware.empty()) service.middleware = middleware;
  told_ = told_ || !middleware.empty();
}

void StatusView::hear(const v1::ClockBeacon& beacon, Time now) {
  std::erase_if(beacons_,
                [&](const auto& entry) { return now - entry.second.second > max_silence; });
  if (beacons_.size() < max_services || beacons_.contains(beacon.service().to_string()))
    beacons_[beacon.service().to_string()] = {beacon, now};
}

void StatusView::hear(const v1::GateState& gate, Time now) {
  std::erase_if(gates_, [&](const auto& entry) { return now - entry.second.second > max_silence; });
  if (gates_.size() < max_services || gates_.contains(gate.hand().to_string()))
    gates_[gate.hand().to_string()] = {gate, now};
}

void StatusView::lose(const std::string& key, Time) {
  if (const auto found = services_.find(key); found != services_.end()) found->second.gone = true;
}

bool StatusView::is_silent(const Service& service, Time now) const {
  return service.gone || now - service.heard > max_silence;
}

std::size_t StatusView::up(std::string_view name, Time now) const {
  return static_cast<std::size_t>(
      std::count_if(services_.begin(), services_.end(), [&](const auto& entry) {
        const Service& service = entry.second;
        return service.status.name().to_string() == name && !is_silent(service, now) &&
               (service.status.state() == v1::STATE_RUNNING ||
                service.status.state() == v1::STATE_DEGRADED);
      }));
}

std::vector<std::string> StatusView::missing(Time now) const {
  std::vector<std::string> names;
  for (const std::string& name : expected_)
    if (std::none_of(services_.begin(), services_.end(), [&](const auto& entry) {
          return entry.second.status.name().to_string() == name && !is_silent(entry.second, now);
        }))
      names.push_back(name);
  return names;
}

const v1::ClockBeacon* StatusView::measure(Time now) const {
  const v1::ClockBeacon* best = nullptr;
  std::ptrdiff_t most = -1;
  for (const auto& [key, heard] : beacons_) {
    if (now - heard.second > max_silence) continue;
    const auto& peers = heard.first.peers();
    const auto known = std::count_if(peers.begin(), peers.end(), [](auto& p) { return p.known(); });
    if (known <= most) continue;
    most = known;
    best = &heard.first;
  }
  return best;
}

std::optional<StatusView::Clock> StatusView::clock(const std::string& key, Time now) const {
  const v1::ClockBeacon* by = measure(now);
  if (!by) return std::nullopt;
  const std::string against = by->service().to_string();
  if (against == key) return Clock{against, 0, 0};
  for (const v1::ClockPeer& peer : by->peers())
    if (peer.known() && peer.service().to_string() == key)
      return Clock{against, 1e-9 * static_cast<double>(peer.offset_ns()),
                   1e-9 * static_cast<double>(peer.uncertainty_ns())};
  return std::nullopt;
}

std::string StatusView::state(const Service& service, Time now) const {
  if (service.gone) return "gone";
  if (is_silent(service, now))
    return fmt::format("silent {}", age(to_seconds(now - service.heard)));
  return std::string(to_string(service.status.state()));
}

std::string StatusView::title(const Service& service) const {
  const auto& name = service.status.name();
  const auto same = std::count_if(services_.begin(), services_.end(), [&](const auto& entry) {
    return entry.second.status.name() == name;
  });
  const std::string whose = service::instance_in(service.status.service().to_string());
  return same < 2 || whose.empty() ? shown(name) : shown(name) + " " + printable(whose);
}

std::string StatusView::page(Time now) const {
  if (services_.empty()) return "no service is there\n" + strangers();
  std::set<std::string> hosts;
  for (const auto& [key, service] : services_) hosts.insert(service.status.host().to_string());
  std::string text =
      fmt::format("{} service{} on {} host{}", services_.size(), services_.size() == 1 ? "" : "s",
                  hosts.size(), hosts.size() == 1 ? "" : "s");
  if (const auto absent = missing(now); !absent.empty())
    text += fmt::format("; missing: {}", fmt::join(absent, ", "));
  if (!refused_.empty()) (text += "\n" + strangers()).pop_back();
  text += fmt::format("\n\n{:<14}{:<18}{:<12}{:>8}{:>9}{}{}\n", "SERVICE", "HOST", "STATE", "UP",
                      "MEMORY", right("CLOCK", 24), told_ ? right("DDS", 15) : "");
  for (const auto& [key, service] : services_) {
    const v1::ServiceStatus& status = service.status;
    const auto offset = clock(key, now);
    const std::string by =
        !offset ? "not known"
        : offset->against == key
            ? "the measure"
            : fmt::format("{:+.4f} s ± {}", offset->offset, latency(1e6 * offset->uncertainty));
    text += fmt::format("{:<14}{:<18}{:<12}{:>8}{:>6.0f} MB{}{}\n", title(service),
                        shown(status.host()), state(service, now), age(status.uptime()),
                        status.resident() / 1e6, right(by, 24),
                        told_ ? right(service.middleware, 15) : "");
    if (status.message().size() > 0) text += fmt::format("  {}\n", shown(status.message()));
  }
  if (const std::string hands = gates(now); !hands.empty())
    text += fmt::format("\n{:<14}{}\n", "HAND", "WHO LEADS IT") + hands;

  const auto section = [&](const std::string& title, const auto& rows) {
    std::string lines;
    for (const auto& [key, service] : services_) rows(service, lines);
    if (!lines.empty()) text += "\n" + title + "\n" + lines;
  };
  section(fmt::format("{:<14}{:<40}{:>10}{:>14}", "SERVICE", "RATE", "A SECOND", "TOTAL"),
          [&](const Service& service, std::string& lines) {
            for (const v1::Rate& rate : service.status.rates())
              lines += fmt::format("{:<14}{:<40}{:>10.1f}{:>14}\n", title(service),
                                   shown(rate.name()), rate.per_second(), rate.total());
          });
  section(fmt::format("{:<14}{:<40}{:>10}{:>10}{:>10}", "SERVICE", "LATENCY", "P50", "P99", "MOST"),
          [&](const Service& service, std::string& lines) {
            for (const v1::StageLatency& stage : service.status.latency())
              lines += fmt::format("{:<14}{:<40}{}{}{}\n", title(service), shown(stage.stage()),
                                   right(latency(stage.p50_us()), 10),
                                   right(latency(stage.p99_us()), 10),
                                   right(latency(stage.max_us()), 10));
          });
  section(fmt::format("{:<14}{:<40}{:>10}{:>14}", "SERVICE", "DROPPED", "NOW", "TOTAL"),
          [&](const Service& service, std::string& lines) {
            for (const v1::Drop& drop : service.status.drops()) {
              const auto fresh = service.fresh_drops.find(drop.reason().to_string());
              lines += fmt::format(
                  "{:<14}{:<40}{:>10}{:>14}\n", title(service), shown(drop.reason()),
                  fresh == service.fresh_drops.end() ? "" : fmt::format("+{}", fresh->second),
                  drop.count());
            }
          });
  return text;
}

std::string StatusView::strangers() const {
  std::string lines;
  for (const std::string& peer : refused_)
    lines += fmt::format("not let in: {}\n", printable(peer));
  return lines;
}

/// Who leads each hand; a stop is what one must not overlook.
std::string StatusView::gates(Time now) const {
  std::string lines;
  for (const auto& [hand, heard] : gates_) {
    const v1::GateState& gate = heard.first;
    if (now - heard.second > max_silence) continue;
    std::string says =
        gate.leader().size() == 0 ? "nobody leads" : gate.leader().to_string() + " leads";
    if (gate.refused().size() > 0) says += "; " + gate.refused().to_string() + " is refused";
    if (gate.stopped())
      says = fmt::format("STOPPED by {}{}{}", gate.stopped_by().to_string(),
                         gate.reason().size() == 0 ? "" : ": ", gate.reason().to_string());
    if (gate.deadman())
      says += gate.consent() ? "; the deadman is held" : "; the deadman is not held";
    lines += fmt::format("{:<14}{}\n", printable(hand), printable(says));
  }
  return lines;
}

std::string StatusView::json(Time now) const {
  using Json = nlohmann::ordered_json;
  Json hands = Json::array();
  for (const auto& [hand, heard] : gates_) {
    const v1::GateState& gate = heard.first;
    if (now - heard.second > max_silence) continue;
    Json counts = Json::object();
    for (const v1::GateCount& one : gate.counts()) counts[one.reason().to_string()] = one.count();
    hands.push_back({{"hand", hand},
                     {"leader", gate.leader().to_string()},
                     {"refused", gate.refused().to_string()},
                     {"stopped", gate.stopped()},
                     {"stopped_by", gate.stopped_by().to_string()},
                     {"reason", gate.reason().to_string()},
                     {"deadman", gate.deadman()},
                     {"consent", gate.consent()},
                     {"obeyed", gate.obeyed()},
                     {"counts", counts}});
  }
  Json list = Json::array();
  for (const auto& [key, service] : services_) {
    const v1::ServiceStatus& status = service.status;
    Json rates = Json::object(), dropped = Json::object(), stages = Json::object();
    for (const v1::Rate& rate : status.rates())
      rates[rate.name().to_string()] = {{"per_second", rate.per_second()}, {"total", rate.total()}};
    for (const v1::Drop& drop : status.drops()) dropped[drop.reason().to_string()] = drop.count();
    for (const v1::StageLatency& stage : status.latency())
      stages[stage.stage().to_string()] = {{"p50", stage.p50_us()},
                                           {"p99", stage.p99_us()},
                                           {"max", stage.max_us()},
                                           {"count", stage.count()}};
    Json time = nullptr;
    if (const auto offset = clock(key, now))
      time = {{"against", offset->against},
              {"offset_s", offset->offset},
              {"uncertainty_s", offset->uncertainty}};
    if (const auto beacon = beacons_.find(key); beacon != beacons_.end() && !time.is_null())
      time["system_clock_was_set_s"] = 1e-9 * static_cast<double>(beacon->second.first.step_ns());
    list.push_back({{"name", status.name().to_string()},
                    {"instance", service::instance_in(key)},
                    {"host", status.host().to_string()},
                    {"key", key},
                    {"state", service.gone              ? "gone"
                              : is_silent(service, now) ? "silent"
                                                        : to_string(status.state())},
                    {"message", status.message().to_string()},
                    {"dds", service.middleware},
                    {"uptime_s", status.uptime()},
                    {"resident_bytes", status.resident()},
                    {"clock", time},
                    {"rates", rates},
                    {"dropped", dropped},
                    {"latency_us", stages}});
  }
  return Json{
      {"services", list}, {"missing", missing(now)}, {"hands", hands}, {"refused", refused_}}
      .dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace prehend::cli
