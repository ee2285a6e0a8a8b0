#pragma once

#include <string>
#include <vector>

#include "common/service/arguments.hpp"
#include "idl/Operation.h"

namespace CLI {
class App;
}

namespace prehend::cli {

/// What an operator asks of the gates before robots, and of which.
struct Order {
  v1::OperatorAction action{};
  std::string argument;

  service::LabArguments lab;
  std::vector<std::string> rigs;  // other rigs than lab.rig
  bool all = false;               // every rig of the domain
  bool json = false;
  double timeout = 5;   // s
  bool on_key = false;  // waits for a key, and gives it then at once

  void add_to(CLI::App& app);
};

/// Who gives an order, for those who read of it later: operator-USER.
std::string operator_name();

/// Gives the order until every gate that is there has answered, and says what they answered. The
/// exit code: 0 when all did what was asked, 1 when one refused or none answered.
int give(const Order& order);

}  // namespace prehend::cli
