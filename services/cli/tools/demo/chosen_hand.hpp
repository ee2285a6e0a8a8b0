#pragma once

#include <string>

#include "services/cli/tools/demo/options.hpp"

namespace prehend::cli {

/// Of --robot KIND:DEVICE: a device that has the name of a hand is that hand; else empty.
std::string hand_of_robot(const std::string& robot);

/// One of those that come with us, whose networks know each object well. Empty: the lab's own.
bool is_ours(const std::string& hand);

/// With --mode, or where that is empty as such a hand does best: the networks of one that was
/// trained in seconds know less than a search for what is seen.
bool is_planned_for(const std::string& hand, const std::string& mode);

/// What services are told of --hand: they may run in other folders, where a hand of this one goes
/// by its whole path.
std::string hand_setting(const std::string& hand);

/// Has a hand trained that was not yet: before the demonstration begins, whose time is short.
Expected<void> train_hand(const DemoOptions& options);

}  // namespace prehend::cli
