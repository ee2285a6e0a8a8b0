#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/service/arguments.hpp"
#include "services/cli/service/outcome.hpp"

namespace prehend::cli {

/// What is demonstrated, and with what.
struct DemoOptions {
  service::LabArguments lab;         // configuration, overrides and domain
  std::uint64_t seed = 1;            // of scene, person and noise
  std::string object;                // empty: drawn by the seed
  std::string hand;                  // empty: the configuration's
  std::vector<std::string> without;  // services that are left out
  std::string glove;                 // DEVICE[:FILE or port]; empty: the first emulated one
  std::string camera;                // SOURCE[:PATH]; empty: the first
  std::string robot;     // emulated:DEVICE moves the simulated hand; empty: nothing does
  std::string arm;       // that carries the hand; empty: the configuration's
  bool direct = false;   // recognition runs, but the mapping does not use it
  bool planned = false;  // grasps are planned for what is seen, before anybody reaches
  bool attach = false;   // starts nothing, judges a lab that runs
  bool keep = false;     // keeps the folder with scene and logs
  double timeout = 45;   // s, until a grasp must have been judged
  std::string record;    // file that takes all topics; empty: none
  bool watch = false;    // with a console, and it goes on until it is interrupted
  /// Told the outcome before it goes on, where it does.
  std::function<void(const Outcome&)> on_outcome = [](const Outcome&) {};
};

}  // namespace prehend::cli
