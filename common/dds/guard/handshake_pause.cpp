#include "common/dds/guard/handshake_pause.hpp"

#include <dlfcn.h>

#include <chrono>
#include <mutex>

#include "common/dds/release/fastdds.hpp"

#if PREHEND_FAST_DDS == 2

// The loader prefers a function of the program to that of a library, also where the library calls
// itself. So these two stand before those of the same names (as `malloc` of a program does).
namespace eprosima::fastrtps::rtps {
class ParticipantProxyData;
namespace security {
class SecurityManager {
 public:
  void remove_participant(const ParticipantProxyData& participant);
  void resend_handshake_message_token(const GUID_t& participant) const;
};
}  // namespace security
}  // namespace eprosima::fastrtps::rtps

namespace prehend::dds {
namespace {

using Manager = eprosima::fastrtps::rtps::security::SecurityManager;
using Proxy = eprosima::fastrtps::rtps::ParticipantProxyData;
using eprosima::fastrtps::rtps::GUID_t;
using Remove = void (*)(Manager*, const Proxy&);
using Resend = void (*)(const Manager*, const GUID_t&);

constexpr char remove_name[] =
    "_ZN8eprosima8fastrtps4rtps8security15SecurityManager18remove_participantERKNS1_"
    "20ParticipantProxyDataE";
constexpr char resend_name[] =
    "_ZNK8eprosima8fastrtps4rtps8security15SecurityManager30resend_handshake_message_tokenERKNS1_"
    "6GUID_tE";

Remove original_remove() {
  static const auto found = reinterpret_cast<Remove>(::dlsym(RTLD_NEXT, remove_name));
  return found;
}
Resend original_resend() {
  static const auto found = reinterpret_cast<Resend>(::dlsym(RTLD_NEXT, resend_name));
  return found;
}

/// Does the loader find ours first?
bool is_ours(const char* name) {
  void* original = ::dlsym(RTLD_NEXT, name);
  return original && ::dlsym(RTLD_DEFAULT, name) != original;
}

/// Held by who removes, and by who repeats. Of the process: its participants need not be told apart
/// for what is that rare.
std::timed_mutex& turn() {
  static auto* instance = new std::timed_mutex;  // outlives the threads of Fast DDS
  return *instance;
}
/// Who removes in the thread of the timers, where a lease ends, must not wait for another one that
/// waits for this thread.
constexpr std::chrono::milliseconds patience{100};

}  // namespace

bool handshakes_pause_for_removals() {
  return is_ours(remove_name) && is_ours(resend_name);
}

}  // namespace prehend::dds

namespace eprosima::fastrtps::rtps::security {

void SecurityManager::remove_participant(const ParticipantProxyData& participant) {
  const std::unique_lock lock(prehend::dds::turn(), prehend::dds::patience);
  prehend::dds::original_remove()(this, participant);
}

void SecurityManager::resend_handshake_message_token(const GUID_t& participant) const {
  const std::unique_lock lock(prehend::dds::turn(), std::try_to_lock);
  if (lock) prehend::dds::original_resend()(this, participant);
}

}  // namespace eprosima::fastrtps::rtps::security

#else

namespace prehend::dds {
bool handshakes_pause_for_removals() {
  return false;
}
}  // namespace prehend::dds

#endif
