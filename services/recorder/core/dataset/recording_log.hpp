#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "services/recorder/core/dataset/series.hpp"

namespace prehend::recorder::dataset {

/// A task that was done, or shown: from when to when.
struct Attempt {
  Time begin, end;
  std::string task;
  std::optional<bool> success;  // where somebody judged it
};

/// A grasp that was judged.
struct Judgement {
  Time time;
  std::string object;
  bool held = false;
  std::optional<Time> until;  // when what was done with the object ended, where that is known
};

/// Pictures of one camera: only when they came. Pictures themselves are read when they are written.
struct Camera {
  std::vector<Time> times;
  int width = 0, height = 0;  // px, of the first one
};

/// What a recording says of one robot hand, of who led it and of what is around it. Times are those
/// at which the recorder received it: one clock for all, and delays as a policy would see them.
/// B: the hand's base, W: the table.
struct RecordingLog {
  std::string model;  // kind of hand
  Numbers command_dof;
  Poses command_X_WB;
  Series<std::string> command_object;  // that the commands are for; empty: none
  Numbers dof, joint, velocity, torque;
  Poses X_WB;
  std::vector<std::string> touch_links;  // that feel something
  Numbers touch_force;                   // N, in B: x, y, z of each of them
  Numbers touch_pressure, touch_slip;    // N and m/s of each of them
  Numbers arm_joint, arm_velocity;
  std::vector<std::string> human_fingers;  // that the glove measures
  Numbers human_fingertips;                // m, in W: x, y, z of each of them
  std::map<std::string, Poses> objects;    // X_WO by name
  bool simulated = false;                  // a world said where they are
  std::map<std::string, Camera> cameras;
  std::vector<Judgement> judgements;
  std::vector<Attempt> runs;   // by the robot
  std::vector<Attempt> shown;  // between the operator's marks
};

}  // namespace prehend::recorder::dataset
