#pragma once

#include <span>
#include <string_view>
#include <utility>

/// Nodes since ROS 2 Iron compare a hash of their types, and warn of who tells none (REP 2011).
namespace prehend::ros2 {

/// Types, as «std_msgs/String», and what an endpoint of such a type announces of itself. A test
/// computes the hashes from idl/ros2.
std::span<const std::pair<std::string_view, std::string_view>> announced_hashes();

/// «typehash=RIHS01_…;», in memory that stays; empty: the type has none.
std::string_view announced_hash(std::string_view type);

}  // namespace prehend::ros2
