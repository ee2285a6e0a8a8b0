#pragma once

#include <string>
#include <string_view>

#include "common/service/config.hpp"

/// A lab has one service of a kind, but a glove, a mapping and a robot for each hand.
namespace prehend::service {

/// Whose it is, by the service's name in the configuration: «left». Empty where a lab has one.
std::string instance_of(const Config& config, std::string_view service);

/// The key of a service's status, NAME@HOST/[INSTANCE/]PID, is unlike that of every other one. Of a
/// long instance it has the first 32 bytes, so that it is whole on the wire.
std::string status_key(std::string_view service, std::string_view host, std::string_view instance);
/// What such a key says of it; empty: nothing.
std::string instance_in(std::string_view key);

}  // namespace prehend::service
