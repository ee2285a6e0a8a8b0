#pragma once

#include <cstdint>
#include <string>

#include "common/service/arguments.hpp"
#include "common/stage/stage.hpp"
#include "services/cli/tools/demo/carry_setting.hpp"

namespace prehend::cli {

struct CarryOptions {
  service::LabArguments lab;
  CarryTask task = CarryTask::carry;
  std::uint64_t seed = 1;  // of where the object stands, its size and weight, of person and noise
  TwoHands hands;
  std::string glove;    // kind of both, see `prehend glove devices`; empty: one that is emulated
  bool attach = false;  // starts nothing, judges a lab that runs
  double timeout = 60;  // s, until it must stand again
  bool keep = false;    // keeps the folder with scene and logs
  std::string record;   // file that takes all topics; empty: none
  bool watch = false;   // with a console, and it goes on until it is interrupted
};

/// A person with two gloves presses a crate between both palms and carries it aside, or hands a
/// tube from one hand to the other; two robot hands in one world do the same: a glove, a mapping
/// and a gate for each.
Expected<Carried> carry(const CarryOptions& options, const stage::Progress& progress);

}  // namespace prehend::cli
