#pragma once

#include <functional>
#include <optional>
#include <string>

#include "common/base/error.hpp"
#include "common/service/shell.hpp"

namespace prehend::recorder {

/// Obeys operator/command and answers on operator/reply. A command is for us when its target is our
/// name or empty. Its order is its argument, or, where that is empty, «start» or «stop» by its
/// action; other actions are not ours.
class OperatorLink {
 public:
  /// Returns what to answer; called in the shell.
  using Obey = std::function<Expected<std::string>(const std::string& order)>;
  /// `player`: who plays old orders here, which are not obeyed.
  OperatorLink(service::Shell& shell, std::string name, Obey execute,
               std::optional<dds::GuidPrefix> player = {});

 private:
  void on_command(const v1::OperatorCommand& command);

  service::Shell& shell_;
  std::string name_;
  Obey obey_;
  std::optional<dds::GuidPrefix> player_;
  service::Shell::Output<v1::OperatorReply> replies_;
};

}  // namespace prehend::recorder
