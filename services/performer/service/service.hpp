#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "common/service/order_book.hpp"
#include "common/service/shell.hpp"
#include "services/performer/service/performer.hpp"

namespace prehend::performer {

/// The topics' side of the performer: an operator orders a task by its name, and the robot hand of
/// the lab does it, from where things stand then.
class Service {
 public:
  /// Fails where the catalogue, the arm or the folder of tasks cannot be used.
  static Expected<std::unique_ptr<Service>> create(service::Shell& shell);

 private:
  Service(service::Shell& shell, std::unique_ptr<Performer> performer, std::filesystem::path tasks);
  void on_order(const v1::OperatorCommand& order, const dds::SampleInfo& info);
  Expected<std::string> start(const std::string& name);
  Expected<std::string> stop(const std::string& name, const std::string& by);

  service::Shell& shell_;
  std::unique_ptr<Performer> performer_;
  std::filesystem::path tasks_;
  service::Shell::Output<v1::OperatorReply> replies_;
  service::OrderBook orders_;
};

/// Keeps with the task how it went, in its file.
void remember(const std::filesystem::path& file, const Performed& performed);

}  // namespace prehend::performer
