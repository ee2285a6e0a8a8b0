#include "services/cli/tools/metrics/metrics_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>

#include "common/base/clock.hpp"
#include "common/base/log.hpp"
#include "common/dds/participant.hpp"
#include "common/service/arguments.hpp"
#include "common/service/membership.hpp"
#include "common/service/supervisor.hpp"
#include "common/tool/interrupt.hpp"
#include "common/web/server.hpp"
#include "services/cli/service/self_reports.hpp"
#include "services/cli/tools/metrics/lab_metrics.hpp"
#include "services/cli/tools/metrics/metrics_site.hpp"

namespace prehend::cli {
namespace {

constexpr Duration round = std::chrono::milliseconds(50);
constexpr std::size_t max_clients = 32;
constexpr Duration patience = std::chrono::seconds(5);

void listen(SelfReports& reports, LabMetrics& metrics, Time now) {
  for (const auto& sample : reports.statuses.take())
    if (sample.info.gone)
      metrics.lose_service(sample.data.service().to_string());
    else
      metrics.hear(sample.data, now);
  for (const auto& sample : reports.beacons.take())
    if (!sample.info.gone) metrics.hear(sample.data, now);
  for (const auto& sample : reports.gates.take())
    if (sample.info.gone)
      metrics.lose_gate(sample.data.hand().to_string());
    else
      metrics.hear(sample.data, now);
}

int serve(const service::Config& config, LabMetrics& metrics, web::Server& server) {
  auto participant = dds::Participant::create(service::membership(config, "prehend", "viewer"));
  if (!participant) return service::complain(participant.error());
  auto reports = SelfReports::create(*participant);
  if (!reports) return service::complain(reports.error());
  tool::note_interrupts();

  const std::string& address = config.text("metrics.address");
  std::cout << fmt::format("http://{}:{}/metrics\n",
                           address.find(':') == std::string::npos ? address : "[" + address + "]",
                           server.port())
            << std::flush;
  service::Supervisor supervisor;
  while (!tool::interrupted()) {
    listen(*reports, metrics, process_now());
    server.run_for(round);
    supervisor.beat(process_now());
  }
  supervisor.stopping();
  return exit_done;
}

}  // namespace

int metrics_command(const std::vector<std::string>& arguments) {
  CLI::App app{
      "Serves what all services of the rig say of themselves to Prometheus, over HTTP, at\n"
      "metrics.address and metrics.port, until SIGTERM or Ctrl-C. Prints the address.",
      "prehend metrics"};
  service::LabArguments lab;
  lab.add_to(app);
  log::set_name("metrics");
  if (const auto code = service::parse(app, arguments)) return *code;
  const auto config = lab.load();
  if (!config) return service::complain(config.error(), exit_wrong_use);
  const std::int64_t port = config->integer("metrics.port");
  if (port < 0 || port > 65535)
    return service::complain({"is no port", "metrics.port", "0 to 65535"}, exit_wrong_use);
  LabMetrics metrics(config->names("lab.services"));
  MetricsSite site([&] { return metrics.text(process_now()); });
  const auto server = web::Server::listen({.address = config->text("metrics.address"),
                                           .port = static_cast<int>(port),
                                           .max_clients = max_clients,
                                           .patience = patience},
                                          site);
  if (!server) return service::complain(server.error());
  return serve(*config, metrics, **server);
}

}  // namespace prehend::cli
