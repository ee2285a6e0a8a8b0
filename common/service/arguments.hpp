#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/service/config.hpp"
#include "common/tool/program.hpp"

namespace prehend::service {

/// Which lab is meant: options that many programs share.
struct LabArguments {
  std::string config;             // lab.toml; empty: the one that came with the programs
  std::vector<std::string> sets;  // table.key=value
  std::optional<int> domain;      // instead of lab.domain

  void add_to(CLI::App& app);
  std::string file() const;
  /// The overrides with the domain among them.
  std::vector<std::string> overrides() const;
  Expected<Config> load() const;
  /// The same lab as the arguments of a service.
  std::vector<std::string> for_service() const;
};

using tool::complain;
using tool::parse;

}  // namespace prehend::service
