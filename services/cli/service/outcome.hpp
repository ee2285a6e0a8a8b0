#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/model/shape.hpp"
#include "idl/Robot.h"

namespace prehend::cli {

/// What a demonstration came to.
struct Outcome {
  struct Object {
    std::string name;
    model::Shape shape;
    std::optional<double> position_error;  // m, horizontal; none where no truth is known
  };
  struct Grasp {
    int contacts = 0;
    double epsilon = -1;  // -1: no force closure
    double volume = 0;
    bool force_closure = false;
    bool held = false;
    std::string reason;  // why it was not held
  };
  struct Arm {
    std::string name;
    double worst_joint_speed = 0;  // share of a joint's limit
    double out_of_reach = 0;       // share of the time, for a limit, something in the way, or reach
  };
  struct Latency {
    double p50 = 0, p99 = 0;  // ms, glove frame read until the world has accepted the command
  };

  std::string target;            // what the synthetic person reached for; empty where nobody knows
  std::optional<Object> object;  // as recognised
  v1::MappingMode mode = v1::MODE_HOLD;  // at closure, or when last followed before it
  double weight = 0;                     // of the intelligent answer
  std::string hand;
  v1::GraspType grasp_type = v1::GRASP_NONE;
  bool judged = false;  // the simulation has reported a grasp
  Grasp grasp;
  std::optional<Latency> latency;
  std::optional<Arm> arm;  // that carries the hand
  std::string device;      // of the glove
  std::uint64_t frames = 0, rejected = 0;
  double seconds = 0;  // from the glove's start to the end
};

/// The JSON document of `prehend demo --json`, on one line.
std::string to_json(const Outcome& outcome);
/// The same for people, several lines.
std::string to_table(const Outcome& outcome);

}  // namespace prehend::cli
