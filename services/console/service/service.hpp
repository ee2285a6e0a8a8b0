#pragma once

#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/dds/participant.hpp"
#include "common/dds/raw.hpp"
#include "common/service/shell.hpp"
#include "common/web/server.hpp"
#include "services/console/service/glove_line.hpp"
#include "services/console/service/graph.hpp"
#include "services/console/service/mailbox.hpp"
#include "services/console/service/show.hpp"

namespace prehend::console {

/// The console of a lab: reads every topic, serves the page, and hands on what its buttons ask.
class Service {
 public:
  static Expected<std::unique_ptr<Service>> create(service::Shell& shell);
  ~Service();
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

 private:
  explicit Service(service::Shell& shell);
  Expected<void> start();
  Expected<void> read_topics();
  Expected<Show::Options> show_options();
  std::string give(const Order& order);
  void consent(const Consent& consent);

  service::Shell& shell_;
  service::Shell::Output<v1::OperatorCommand> orders_;
  service::Shell::Output<v1::OperatorConsent> consents_;
  std::uint64_t given_ = 0, consented_ = 0;
  std::uint64_t told_lost_ = 0;  // as the status tells
  Mailbox mailbox_;
  Graph graph_;
  std::optional<dds::Participant> participant_;
  std::vector<std::unique_ptr<dds::RawReader>> readers_;
  std::unique_ptr<GloveLine> glove_;  // nothing: the lab's glove is another one
  std::unique_ptr<Show> show_;
  std::unique_ptr<web::Server> server_;
  std::thread thread_;  // of the server
};

}  // namespace prehend::console
