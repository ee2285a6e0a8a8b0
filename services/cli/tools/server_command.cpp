#include "services/cli/tools/server_command.hpp"

#include <signal.h>

#include <CLI/CLI.hpp>

#include "common/base/clock.hpp"
#include "common/base/log.hpp"
#include "common/service/membership.hpp"
#include "common/service/supervisor.hpp"
#include "services/cli/tools/arguments.hpp"

namespace prehend::cli {

int server_command(const std::vector<std::string>& arguments) {
  CLI::App app{
      "The discovery server of a lab without multicast (lab.network = \"server\"): services that\n"
      "name it in lab.server find each other through it. Samples do not pass through it. Runs "
      "until\n"
      "SIGTERM or Ctrl-C.",
      "prehend discovery-server"};
  LabArguments lab;
  std::string listen = "0.0.0.0:11811";
  std::vector<std::string> links;
  lab.add_to(app);
  app.add_option("--listen", listen, "ADDRESS:PORT, 0.0.0.0: at every interface")
      ->capture_default_str();
  app.add_option("--link", links,
                 "ADDRESS:PORT of another server, whose clients ours shall find too; may be\n"
                 "repeated. Linked servers have different ports")
      ->type_size(1)
      ->allow_extra_args(false);
  if (const auto code = parse(app, arguments)) return *code;
  log::set_name("discovery-server");

  const auto config = lab.load();
  if (!config) return complain(config.error(), exit_wrong_use);
  // Before any thread starts, so that all inherit it.
  sigset_t ends;
  sigemptyset(&ends);
  sigaddset(&ends, SIGTERM);
  sigaddset(&ends, SIGINT);
  pthread_sigmask(SIG_BLOCK, &ends, nullptr);
  dds::ParticipantOptions options = service::membership(*config, "discovery-server");
  options.network.profile = "server";
  options.network.servers = links;
  options.serves = listen;
  // Clients of a server that was here until now must have missed it.
  const timespec silence{1, 200'000'000};
  if (sigtimedwait(&ends, nullptr, &silence) > 0) return exit_done;
  const auto server = dds::Participant::create(options);
  if (!server) return complain(server.error(), exit_broken);
  log::info("listens at {}", listen);
  service::Supervisor supervisor;
  supervisor.beat(process_now());
  const timespec round{0, 250'000'000};
  while (sigtimedwait(&ends, nullptr, &round) <= 0) supervisor.beat(process_now());
  supervisor.stopping();
  return exit_done;
}

}  // namespace prehend::cli
