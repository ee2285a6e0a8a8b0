#include "status_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <iostream>
#include <nlohmann/json.hpp>
#include <prehend/base/time.hpp>
#include <thread>

#include "arguments.hpp"
#include "listener.hpp"
#include "observer.hpp"

namespace prehend::cli {
namespace {

std::string_view to_string(v1::ServiceState state) {
  switch (state) {
    case v1::STATE_RUNNING:
      return "running";
    case v1::STATE_DEGRADED:
      return "degraded";
    case v1::STATE_STOPPING:
      return "stopping";
    default:
      return "starting";
  }
}

}  // namespace

std::string status_json(const std::map<std::string, v1::ServiceStatus>& services) {
  using Json = nlohmann::ordered_json;
  Json list = Json::array();
  for (const auto& [key, status] : services) {
    Json rates = Json::object(), dropped = Json::object(), latency = Json::object();
    for (const v1::Rate& rate : status.rates())
      rates[rate.name().to_string()] = {{"per_second", rate.per_second()}, {"total", rate.total()}};
    for (const v1::Drop& drop : status.drops()) dropped[drop.reason().to_string()] = drop.count();
    for (const v1::StageLatency& stage : status.latency())
      latency[stage.stage().to_string()] = {{"p50", stage.p50_us()},
                                            {"p99", stage.p99_us()},
                                            {"max", stage.max_us()},
                                            {"count", stage.count()}};
    list.push_back({{"name", status.name().to_string()},
                    {"host", status.host().to_string()},
                    {"state", to_string(status.state())},
                    {"message", status.message().to_string()},
                    {"uptime_s", status.uptime()},
                    {"resident_bytes", status.resident()},
                    {"rates", rates},
                    {"dropped", dropped},
                    {"latency_us", latency}});
  }
  return Json{{"services", list}}.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string status_table(const std::map<std::string, v1::ServiceStatus>& services) {
  if (services.empty()) return "no service is there\n";
  std::string text;
  for (const auto& [key, status] : services) {
    text += fmt::format("{:<14}{:<16}{:<10}{:>6.0f} MB  {:.0f} s  {}\n", status.name().to_string(),
                        status.host().to_string(), to_string(status.state()),
                        status.resident() / 1e6, status.uptime(), status.message().to_string());
    for (const v1::Rate& rate : status.rates())
      text += fmt::format("  {:<32}{:>9.1f} /s {:>10}\n", rate.name().to_string(),
                          rate.per_second(), rate.total());
    for (const v1::Drop& drop : status.drops())
      text += fmt::format("  dropped: {:<23}{:>23}\n", drop.reason().to_string(), drop.count());
    for (const v1::StageLatency& stage : status.latency())
      text += fmt::format("  {:<32}p50 {:.0f} µs, p99 {:.0f} µs\n", stage.stage().to_string(),
                          stage.p50_us(), stage.p99_us());
  }
  return text;
}

int status_command(const std::vector<std::string>& arguments) {
  CLI::App app{"Who is there and how they fare.", "prehend status"};
  LabArguments lab;
  std::vector<std::string> awaited;
  bool json = false;
  double timeout = 1.5;
  lab.add_to(app);
  app.add_option("--wait", awaited,
                 "ends as soon as this service is up, with exit code 1 when it is not in time")
      ->type_size(1)
      ->allow_extra_args(false);
  app.add_option("--timeout", timeout, "s to listen")->check(CLI::Range(0.1, 3600.0));
  app.add_flag("--json", json, "one JSON document on standard output");
  if (const auto code = parse(app, arguments)) return *code;

  const auto config = lab.load();
  if (!config) return complain(config.error(), exit_wrong_use);
  auto listener = Listener::create(*config, false);
  if (!listener) return complain(listener.error(), exit_broken);
  Observer observer;
  const auto all_up = [&] {
    return std::all_of(awaited.begin(), awaited.end(),
                       [&](const std::string& name) { return observer.is_up(name); });
  };
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + prehend::seconds(timeout);
  while (Clock::now() < end && (awaited.empty() || !all_up())) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    listener->poll(observer);
  }
  std::cout << (json ? status_json(observer.services()) + "\n" : status_table(observer.services()));
  if (!awaited.empty()) return all_up() ? exit_done : exit_no;
  return observer.services().empty() ? exit_no : exit_done;
}

}  // namespace prehend::cli
