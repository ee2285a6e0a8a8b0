#include "services/cli/tools/metrics/lab_metrics.hpp"

#include <algorithm>
#include <functional>

#include "common/service/status.hpp"

namespace prehend::cli {
namespace {

constexpr Duration max_silence = std::chrono::seconds(3);  // a status comes once a second
constexpr Duration forgotten = std::chrono::seconds(60);   // what is silent
constexpr std::size_t max_known = 100;                     // of each kind: a page stays a page

using Labels = Exposition::Labels;

template <class Heard>
bool is_up(const Heard& heard, Time now) {
  return !heard.gone && now - heard.at <= max_silence;
}

/// Keeps the message, if there is room for one more. Returns where, or nothing.
template <class Message, class Known>
auto* keep(Known& known, const std::string& key, const Message& message, Time now) {
  std::erase_if(known, [&](const auto& entry) { return now - entry.second.at > forgotten; });
  const bool room = known.size() < max_known || known.contains(key);
  auto* kept = room ? &known[key] : nullptr;
  if (kept) *kept = {message, now, false};
  return kept;
}

/// The process behind a key NAME@HOST/PID.
Labels labels_of(const std::string& key) {
  const std::size_t at = key.find('@'), slash = key.rfind('/');
  if (at == std::string::npos || slash == std::string::npos || slash < at)
    return {{"service", key}, {"host", ""}, {"pid", ""}};
  return {{"service", key.substr(0, at)},
          {"host", key.substr(at + 1, slash - at - 1)},
          {"pid", key.substr(slash + 1)}};
}

/// Calls say(of(key), message) for each that is heard.
template <class Known, class Say, class Of = std::identity>
void each_up(const Known& known, Time now, const Say& say, const Of& of = {}) {
  for (const auto& [key, heard] : known)
    if (is_up(heard, now)) say(of(key), heard.message);
}

Labels with(Labels labels, std::string_view name, std::string value) {
  labels.emplace_back(name, std::move(value));
  return labels;
}

}  // namespace

void LabMetrics::hear(const v1::ServiceStatus& status, Time now) {
  const std::string key = status.service().to_string();
  const auto known = services_.find(key);
  // The same process, started anew in its place, counts its time from 0.
  const bool started = known == services_.end() || status.uptime() < known->second.message.uptime();
  if (!keep(services_, key, status, now) || !started) return;
  const Place place{status.name().to_string(), status.host().to_string()};
  if (starts_.size() < max_known || starts_.contains(place)) ++starts_[place];
}

void LabMetrics::hear(const v1::ClockBeacon& beacon, Time now) {
  keep(beacons_, beacon.service().to_string(), beacon, now);
}

void LabMetrics::hear(const v1::GateState& gate, Time now) {
  keep(gates_, gate.hand().to_string(), gate, now);
}

void LabMetrics::lose_service(const std::string& key) {
  if (const auto found = services_.find(key); found != services_.end()) found->second.gone = true;
}

void LabMetrics::lose_gate(const std::string& hand) {
  if (const auto found = gates_.find(hand); found != gates_.end()) found->second.gone = true;
}

void LabMetrics::add_processes(Exposition& page, Time now) const {
  std::map<std::string, int> running;
  for (const std::string& name : expected_) running[name] = 0;
  for (const auto& [key, heard] : services_)
    running[heard.message.name().to_string()] += is_up(heard, now) ? 1 : 0;
  page.gauge("prehend_processes", "Processes of a service that are heard; 0: it is missing.");
  for (const auto& [name, count] : running) page.number({{"service", name}}, count);
  page.counter("prehend_starts_total", "Starts of a service that this exporter has seen.");
  for (const auto& [place, count] : starts_)
    page.count({{"service", place.first}, {"host", place.second}}, count);
  page.gauge("prehend_up", "1: the process is heard. 0: it is gone, or silent for 3 s.");
  for (const auto& [key, heard] : services_) page.number(labels_of(key), is_up(heard, now) ? 1 : 0);
}

void LabMetrics::add_health(Exposition& page, Time now) const {
  const auto each = [&](const auto& say) { each_up(services_, now, say, labels_of); };
  page.gauge("prehend_state", "1: the process says that it is in this state.");
  each([&](const Labels& labels, const v1::ServiceStatus& status) {
    for (const auto& row : service::state_names)
      page.number(with(labels, "state", std::string(row.name)),
                  status.state() == row.value ? 1 : 0);
  });
  page.gauge("prehend_uptime_seconds", "Time since the process began.");
  each([&](const Labels& labels, const v1::ServiceStatus& status) {
    page.number(labels, status.uptime());
  });
  page.gauge("prehend_resident_bytes", "Memory of the process.");
  each([&](const Labels& labels, const v1::ServiceStatus& status) {
    page.number(labels, status.resident());
  });
}

void LabMetrics::add_work(Exposition& page, Time now) const {
  const auto each = [&](const auto& say) { each_up(services_, now, say, labels_of); };
  page.counter("prehend_events_total", "What the process has done: frames, commands, ...");
  each([&](const Labels& labels, const v1::ServiceStatus& status) {
    for (const v1::Rate& rate : status.rates())
      page.count(with(labels, "event", rate.name().to_string()), rate.total());
  });
  page.gauge("prehend_events_per_second", "The same, in the last second.");
  each([&](const Labels& labels, const v1::ServiceStatus& status) {
    for (const v1::Rate& rate : status.rates())
      page.number(with(labels, "event", rate.name().to_string()), rate.per_second());
  });
  page.counter("prehend_drops_total", "Input that was not used, by reason.");
  each([&](const Labels& labels, const v1::ServiceStatus& status) {
    for (const v1::Drop& drop : status.drops())
      page.count(with(labels, "reason", drop.reason().to_string()), drop.count());
  });
  page.gauge("prehend_latency_seconds", "Quantiles of the last 1024 latencies of a stage.");
  each([&](const Labels& labels, const v1::ServiceStatus& status) {
    for (const v1::StageLatency& stage : status.latency()) {
      if (stage.count() == 0) continue;
      const Labels named = with(labels, "stage", stage.stage().to_string());
      page.number(with(named, "quantile", "0.5"), 1e-6 * stage.p50_us());
      page.number(with(named, "quantile", "0.99"), 1e-6 * stage.p99_us());
      page.number(with(named, "quantile", "1"), 1e-6 * stage.max_us());
    }
  });
}

void LabMetrics::add_clocks(Exposition& page, Time now) const {
  page.gauge("prehend_peers", "Processes whose clock this one knows.");
  const auto each = [&](const auto& say) { each_up(beacons_, now, say, labels_of); };
  each([&](const Labels& labels, const v1::ClockBeacon& beacon) {
    const auto& peers = beacon.peers();
    page.number(labels,
                static_cast<double>(std::count_if(peers.begin(), peers.end(),
                                                  [](const auto& peer) { return peer.known(); })));
  });
  page.gauge("prehend_clock_step_seconds",
             "How far the system's clock was set away from the process since its start.");
  each([&](const Labels& labels, const v1::ClockBeacon& beacon) {
    page.number(labels, 1e-9 * static_cast<double>(beacon.step_ns()));
  });
}

void LabMetrics::add_gates(Exposition& page, Time now) const {
  page.gauge("prehend_gate_up",
             "1: the gate of this hand is heard. 0: it is gone, or silent for 3 s.");
  for (const auto& [hand, heard] : gates_) page.number({{"hand", hand}}, is_up(heard, now) ? 1 : 0);
  const auto each = [&](const auto& say) { each_up(gates_, now, say); };
  page.gauge("prehend_gate_led", "1: somebody's commands are obeyed.");
  each([&](const std::string& hand, const v1::GateState& gate) {
    page.number({{"hand", hand}}, gate.leader().size() > 0 ? 1 : 0);
  });
  page.gauge("prehend_gate_contended", "1: somebody else sends commands, too, and is refused.");
  each([&](const std::string& hand, const v1::GateState& gate) {
    page.number({{"hand", hand}}, gate.refused().size() > 0 ? 1 : 0);
  });
  page.counter("prehend_gate_obeyed_total", "Commands that were obeyed.");
  each([&](const std::string& hand, const v1::GateState& gate) {
    page.count({{"hand", hand}}, gate.obeyed());
  });
  page.counter("prehend_gate_refusals_total", "Commands that were refused or cut, by reason.");
  each([&](const std::string& hand, const v1::GateState& gate) {
    for (const v1::GateCount& one : gate.counts())
      page.count({{"hand", hand}, {"reason", one.reason().to_string()}}, one.count());
  });
}

void LabMetrics::add_stops(Exposition& page, Time now) const {
  const auto each = [&](const auto& say) { each_up(gates_, now, say); };
  page.gauge("prehend_gate_stopped", "1: stopped until the release.");
  each([&](const std::string& hand, const v1::GateState& gate) {
    page.number({{"hand", hand}}, gate.stopped() ? 1 : 0);
  });
  page.gauge("prehend_gate_stop_info", "Who stopped the hand, and why, as long as it is stopped.");
  each([&](const std::string& hand, const v1::GateState& gate) {
    if (gate.stopped())
      page.number({{"hand", hand},
                   {"by", gate.stopped_by().to_string()},
                   {"reason", gate.reason().to_string()}},
                  1);
  });
  page.gauge("prehend_gate_deadman", "1: nothing is obeyed without operator/consent.");
  each([&](const std::string& hand, const v1::GateState& gate) {
    page.number({{"hand", hand}}, gate.deadman() ? 1 : 0);
  });
  page.gauge("prehend_gate_consent", "1: the consent is there.");
  each([&](const std::string& hand, const v1::GateState& gate) {
    page.number({{"hand", hand}}, gate.consent() ? 1 : 0);
  });
}

std::string LabMetrics::text(Time now) const {
  Exposition page;
  add_processes(page, now);
  add_health(page, now);
  add_work(page, now);
  add_clocks(page, now);
  add_gates(page, now);
  add_stops(page, now);
  return page.text();
}

}  // namespace prehend::cli
