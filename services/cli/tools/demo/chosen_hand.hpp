#pragma once

#include <string>

#include "services/cli/tools/demo/options.hpp"

namespace prehend::cli {

/// Of --robot KIND:DEVICE: a device that has the name of a hand is that hand; else empty.
std::string hand_of_robot(const std::string& robot);

/// One of those that come with us, whose networks know each object well.
bool is_ours(const std::string& hand);

/// What services are told of --hand: they may run in other folders, where a hand of this one goes
/// by its whole path.
std::string hand_setting(const std::string& hand);

/// Has a hand trained that was not yet: before the demonstration begins, whose time is short.
Expected<void> train_hand(const DemoOptions& options);

}  // namespace prehend::cli
