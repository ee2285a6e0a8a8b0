#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "services/console/core/documents.hpp"
#include "services/console/core/view.hpp"

namespace prehend::console {

/// Who is there, who is missing and why, and what gates let through. Pure.
class Roster {
 public:
  /// What has happened, for the log.
  struct Event {
    LogLevel level{};
    std::string name, text;
  };
  struct News {
    std::vector<Event> events = {};
    bool services = false, gates = false;  // is other now
  };

  /// services: that a whole lab has.
  explicit Roster(std::vector<std::string> services) : wanted_(std::move(services)) {}

  News hear_status(View message, std::int64_t now_ns);
  News hear_gate(View message);
  /// By the last message of what has ended.
  News lose_status(View last);
  News lose_gate(View last);
  /// Time has passed: who was killed, or is behind a broken network, says no farewell.
  News wait(std::int64_t now_ns);

  /// The document of /status.
  Json everybody() const;
  /// The document of /latency.
  Json latency() const;

 private:
  struct Service {
    std::string name, host, state, message;
    std::int64_t dropped = 0;
    Json latency;
    std::int64_t heard_ns = 0;
    bool silent = false;
  };
  struct Gate {
    std::string leader, stopped_by, reason;
    bool stopped = false, deadman = false, consent = false;
  };
  static Service read(View message, const std::string& key, std::int64_t now_ns);
  /// Who ought to be there and is not, and why.
  Json missing() const;

  std::vector<std::string> wanted_;
  std::map<std::string, Service> services_;
  std::set<std::string> left_;  // names of those that have said farewell
  std::map<std::string, Gate> gates_;
};

}  // namespace prehend::console
