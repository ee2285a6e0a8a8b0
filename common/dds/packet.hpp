#pragma once

#include <cstdint>
#include <memory>
#include <span>

namespace eprosima::fastdds::rtps {
struct TransportDescriptorInterface;
}

namespace prehend::dds {

/// Whether the bytes are an RTPS message whose parts lie within it (DDSI-RTPS 2.3, 8.3.3
/// and 9.4.5). Fast DDS 2.9 as Debian builds it ends the process over one that is not: its own
/// statistics part must be the last and as long as it makes it.
bool is_sound(std::span<const std::uint8_t> message);

/// The same transport, without messages that are not sound.
std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> guarded(
    std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> transport);

/// Messages of this process that were dropped so.
std::uint64_t unsound_messages();

}  // namespace prehend::dds
