#include "common/dds/security.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <set>

#include "common/base/file_text.hpp"
#include "common/keys/certificate.hpp"

namespace prehend::dds {

namespace {

constexpr const char* anew = "make the key anew with `prehend keys add`, and copy its whole folder";

Expected<std::string> text_of(const std::filesystem::path& file) {
  auto text = read_file(file, anew);
  if (text && text->empty()) return fail("is empty", file.string(), anew);
  return text;
}

/// The folder of one key.
std::filesystem::path find_folder(const std::filesystem::path& given, std::string_view role) {
  std::error_code code;
  const auto of_role = given / role;
  return std::filesystem::exists(given / key_files::certificate, code) ? given : of_role;
}

}  // namespace

Expected<Keys> load_keys(const std::filesystem::path& given, std::string_view role, Time now) {
  Keys keys;
  keys.folder = find_folder(given, role);
  std::error_code code;
  if (!std::filesystem::is_directory(keys.folder, code))
    return fail("there are no keys", keys.folder.string(),
                fmt::format("lab.keys names their folder; `prehend keys add {}` makes them", role));
  std::string authority, governance, permissions;
  keys::Identity identity;
  for (const auto& [name, text] :
       {std::pair(key_files::authority, &authority),
        std::pair(key_files::certificate, &identity.certificate),
        std::pair(key_files::key, &identity.key), std::pair(key_files::governance, &governance),
        std::pair(key_files::permissions, &permissions),
        std::pair(key_files::revoked, &keys.revoked)}) {
    auto read = text_of(keys.folder / name);
    if (!read) return tl::unexpected(read.error());
    *text = std::move(*read);
  }
  const auto at = [&](const char* name) { return (keys.folder / name).string(); };
  struct ::stat status {};
  if (::stat(at(key_files::key).c_str(), &status) != 0 || (status.st_mode & 077) != 0)
    return fail("the private key can be read by others", at(key_files::key),
                "chmod 600 " + at(key_files::key));
  const auto facts = keys::facts(identity.certificate);
  if (!facts) return fail(facts.error().what, at(key_files::certificate), anew);
  keys.subject = facts->subject;
  keys.authority = facts->issuer;
  keys.expires = facts->valid.until;
  if (const auto good = keys::check(identity, authority, keys.revoked, now); !good)
    return fail(good.error().what, at(key_files::certificate), anew);
  if (const auto good = keys::verified(governance, authority); !good)
    return fail(good.error().what, at(key_files::governance), anew);
  const auto permitted = keys::verified(permissions, authority);
  if (!permitted) return fail(permitted.error().what, at(key_files::permissions), anew);
  auto read = read_permissions(*permitted);
  if (!read) return fail(read.error().what, at(key_files::permissions), anew);
  if (read->subject != keys.subject)
    return fail(fmt::format("the permissions are for {}, the certificate is of {}", read->subject,
                            keys.subject),
                at(key_files::permissions), anew);
  keys.permissions = std::move(*read);
  return keys;
}

std::optional<std::string> newer_list(const Keys& keys) {
  auto list = text_of(keys.folder / key_files::revoked);
  if (!list || *list == keys.revoked) return std::nullopt;
  // Perhaps it is still being copied.
  const auto authority = text_of(keys.folder / key_files::authority);
  if (!authority) return std::nullopt;
  const auto newer = keys::revoked(*list, *authority);
  const auto known = keys::revoked(keys.revoked, *authority);
  if (!newer) return std::nullopt;
  // One that was only signed anew says nothing new.
  const auto serials = [](const auto& entries) {
    std::set<std::string> all;
    for (const auto& one : entries) all.insert(one.serial);
    return all;
  };
  if (known && serials(*known) == serials(*newer)) return std::nullopt;
  return std::move(*list);
}

std::optional<Error> old_list(const Keys& keys, Duration max_age, Time now) {
  if (max_age <= Duration::zero()) return std::nullopt;
  const auto list = text_of(keys.folder / key_files::revoked);
  const auto when = list ? keys::signed_at(*list) : tl::unexpected(list.error());
  if (when && now - *when <= max_age) return std::nullopt;
  return Error{when ? fmt::format("the list of revoked keys is {:.1f} days old",
                                  to_seconds(now - *when) / 86400)
                    : when.error().what,
               (keys.folder / key_files::revoked).string(),
               "prehend keys refresh, and copy revoked.pem", exit_broken};
}

void secure(fdds::DomainParticipantQos& qos, const Keys& keys) {
  auto& properties = qos.properties().properties();
  const auto set = [&](const char* name, const std::string& value) {
    properties.emplace_back(name, value);
  };
  const auto file = [&](const char* name) {
    return "file://" + std::filesystem::absolute(keys.folder / name).string();
  };
  set("dds.sec.auth.plugin", "builtin.PKI-DH");
  set("dds.sec.auth.builtin.PKI-DH.identity_ca", file(key_files::authority));
  set("dds.sec.auth.builtin.PKI-DH.identity_certificate", file(key_files::certificate));
  set("dds.sec.auth.builtin.PKI-DH.private_key", file(key_files::key));
  set("dds.sec.auth.builtin.PKI-DH.identity_crl", file(key_files::revoked));
  set("dds.sec.crypto.plugin", "builtin.AES-GCM-GMAC");
  set("dds.sec.access.plugin", "builtin.Access-Permissions");
  set("dds.sec.access.builtin.Access-Permissions.permissions_ca", file(key_files::authority));
  set("dds.sec.access.builtin.Access-Permissions.governance", file(key_files::governance));
  set("dds.sec.access.builtin.Access-Permissions.permissions", file(key_files::permissions));
}

// An authenticated participant's GUID begins with a one (DDS Security 1.1, 9.3.3): the plugin sets
// it from the certificate. An unsecured one's begins with the vendor, 01.
Expected<void> confirm(const fdds::DomainParticipant& participant, const Keys& keys) {
  if (participant.guid().guidPrefix.value[0] & 0x80) return {};
  return fail("security did not take effect", keys.folder.string(),
              "is this Fast DDS built with security?");
}

}  // namespace prehend::dds
