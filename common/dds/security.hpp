#pragma once

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "common/dds/permissions.hpp"
#include "common/dds/release/fastdds.hpp"

namespace prehend::dds {

/// What lies in the folder of one key; `prehend keys` makes it.
namespace key_files {
inline constexpr const char* authority = "authority.pem";  // the certificate that vouches for all
inline constexpr const char* certificate = "certificate.pem";
inline constexpr const char* key = "key.pem";  // private, mode 0600
inline constexpr const char* governance = "governance.p7s";
inline constexpr const char* permissions = "permissions.p7s";
inline constexpr const char* revoked = "revoked.pem";
}  // namespace key_files

/// Keys are asked to be renewed when they expire within this time.
inline constexpr std::chrono::days expiry_warning{30};

/// The keys of a process.
struct Keys {
  std::filesystem::path folder;
  std::string subject, authority;  // names, in the order of RFC 2253
  Time expires;
  Permissions permissions;
  std::string revoked;  // the list as it was read
};

/// Keys that are whole and valid now; everything in the folder is checked, because Fast DDS says
/// only that it could not. `given` is the folder of one key, or one with a folder for each role.
Expected<Keys> load_keys(const std::filesystem::path& given, std::string_view role, Time now);

/// The list of revoked keys, if the authority has revoked others since these were loaded. Fast
/// DDS takes notice of it only when a participant is made.
std::optional<std::string> newer_list(const Keys& keys);

/// What is wrong with the list that lies there, if it is older than this; zero: it may be.
std::optional<Error> old_list(const Keys& keys, Duration max_age, Time now);

/// Makes the participant a secured one.
void secure(eprosima::fastdds::dds::DomainParticipantQos& qos, const Keys& keys);
/// That it really is one: otherwise it must not go on.
Expected<void> confirm(const eprosima::fastdds::dds::DomainParticipant& participant,
                       const Keys& keys);

}  // namespace prehend::dds
