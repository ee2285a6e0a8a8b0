#pragma once

namespace prehend::dds {

/// Fast DDS 2.9.1 locks itself up when it repeats a message of a handshake while a participant with
/// keys is being removed: who removes holds the lock of the security plugin and waits for the
/// thread of the timers; that thread waits for the same lock to repeat the message. Two of its
/// functions are called through ours (handshake_pause.cpp): what would be repeated during a removal
/// is repeated half a second later. False: they are not, for the library has no such functions.
bool handshakes_pause_for_removals();

}  // namespace prehend::dds
