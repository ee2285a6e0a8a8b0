#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/pose.hpp"

namespace prehend::tasks {

/// The table, as what something is placed relative to.
inline constexpr const char* the_table = "table";

/// One thing is taken and put somewhere. O: the object, G: the grasp frame, R: the reference.
struct Step {
  std::string object;  // its name, not a track
  std::string grasp;   // kind of grasp; empty: any
  Pose X_OG = Pose::Identity();
  std::string reference = the_table;  // another object, or the table
  Pose X_RO = Pose::Identity();       // where it is put
  double spread = 0;                  // m, between demonstrations, of that place
  double via_height = 0;              // m, so far above the higher one of start and end
  bool upright = false;               // its z axis stays up
  std::vector<std::size_t> after;     // steps that must be done before
};

/// A task as it can be done again elsewhere: it says nothing of where things stood.
struct TaskModel {
  std::string name;
  std::size_t demonstrations = 0;  // that it was learnt from
  std::vector<Step> steps;         // in the order in which they were shown first
};

/// How far an object's z axis points from up, rad: what stays upright keeps it small.
double tilt(const Pose& X_WO);

/// What a task must be: a name, steps with objects, finite poses, a reference that is not the
/// object itself, an order without circles. Errors name the step.
Expected<void> check(const TaskModel& task);

/// What to say of an object or reference of its steps that `is_there` denies; nothing: all are
/// there.
std::optional<Error> lacking(const TaskModel& task,
                             const std::function<bool(const std::string&)>& is_there);

/// An order of the steps that keeps `after`, earlier steps first; fails on a circle.
Expected<std::vector<std::size_t>> order_of(const TaskModel& task);

}  // namespace prehend::tasks
