#include "services/cli/tools/keys/keystore.hpp"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <random>
#include <system_error>

#include "common/base/file_text.hpp"
#include "common/dds/security.hpp"
#include "common/keys/certificate.hpp"

namespace prehend::cli {

namespace fs = std::filesystem;
namespace files = dds::key_files;

namespace {

constexpr const char* authority_key = "authority-key.pem";
constexpr auto authority_validity = std::chrono::days(3650);
/// Clocks of other hosts may be behind.
constexpr auto clock_tolerance = std::chrono::days(1);

/// Whole or not at all, whoever reads at the same time.
Expected<void> write(const fs::path& file, std::string_view text, ::mode_t mode) {
  const std::string draft = file.string() + ".new";
  ::unlink(draft.c_str());
  const int handle = ::open(draft.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
  bool good = handle >= 0;
  for (std::size_t done = 0; good && done < text.size();) {
    const ssize_t written = ::write(handle, text.data() + done, text.size() - done);
    good = written > 0;
    if (good) done += static_cast<std::size_t>(written);
  }
  good = good && ::fchmod(handle, mode) == 0 && ::fsync(handle) == 0;
  const int why = errno;
  if (handle >= 0) ::close(handle);
  if (good && ::rename(draft.c_str(), file.c_str()) == 0) return {};
  const int reason = good ? errno : why;
  ::unlink(draft.c_str());
  return fail(std::string("cannot be written: ") + std::strerror(reason), file.string(),
              "is there room, and may you write there?");
}

std::string utc(Time time) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}", std::chrono::floor<std::chrono::seconds>(time));
}

bool good_name(const std::string& name) {
  return !name.empty() && name.size() <= 48 && name.front() != '-' &&
         name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_-") == std::string::npos;
}

}  // namespace

std::optional<dds::Role> role_of(std::string_view name) {
  for (const auto& [role, word] : dds::role_names)
    if (name == word || (name.starts_with(word) && name[word.size()] == '-')) return role;
  return std::nullopt;
}

Expected<Keystore> Keystore::init(const fs::path& folder, Duration validity, Time now,
                                  const dds::Scope& scope) {
  std::error_code code;
  if (fs::exists(folder, code) && !fs::is_empty(folder, code))
    return fail("is there already", folder.string(), "name a new folder");
  fs::create_directories(folder, code);
  if (code) return fail(code.message(), folder.string(), "may you write there?");
  fs::permissions(folder, fs::perms::owner_all, code);
  const Keystore made(folder);
  // Two labs are told apart by their authorities' names.
  const std::string name = fmt::format("Prehend lab {:08x}", std::random_device{}());
  const keys::Validity valid{now - clock_tolerance, now + authority_validity};
  const auto authority = keys::make_authority(name, valid);
  if (!authority) return tl::unexpected(authority.error());
  const auto list = keys::revocation_list(*authority, {}, valid);
  if (!list) return tl::unexpected(list.error());
  const auto governance = keys::sign(*authority, dds::governance_text());
  if (!governance) return tl::unexpected(governance.error());
  for (const auto& [file, text, mode] :
       {std::tuple(files::authority, &authority->certificate, 0644),
        std::tuple(authority_key, &authority->key, 0600), std::tuple(files::revoked, &*list, 0644),
        std::tuple(files::governance, &*governance, 0644)})
    if (const auto done = write(folder / file, *text, static_cast<::mode_t>(mode)); !done)
      return tl::unexpected(done.error());
  for (const auto& [role, word] : dds::role_names)
    if (const auto done = made.add(std::string(word), role, validity, false, now, scope); !done)
      return tl::unexpected(done.error());
  return made;
}

Expected<Keystore> Keystore::open(const fs::path& folder) {
  std::error_code code;
  if (!fs::exists(folder / authority_key, code))
    return fail("is no keystore", folder.string(),
                "`prehend keys init DIR` makes one; --store names it");
  return Keystore(folder);
}

Expected<std::string> Keystore::read(const fs::path& name) const {
  return read_file(folder_ / name, "may you read it?");
}

std::vector<std::string> Keystore::names() const {
  std::vector<std::string> names;
  std::error_code code;
  for (const auto& entry : fs::directory_iterator(folder_, code))
    if (entry.is_directory(code)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

Expected<void> Keystore::add(const std::string& name, dds::Role role, Duration validity, bool renew,
                             Time now, const dds::Scope& scope) const {
  if (!good_name(name))
    return fail("is no name for a key", name, "small letters, digits, - and _, at most 48");
  std::error_code code;
  if (fs::exists(folder_ / name, code) && !renew) {
    const auto all = entries(now);
    if (!all) return tl::unexpected(all.error());
    for (const Entry& entry : *all)
      if (entry.name == name && !entry.revoked)
        return fail("there is a key of this name", name, "--renew replaces it, or revoke it first");
  }
  const auto certificate = read(files::authority), secret = read(authority_key),
             list = read(files::revoked), governance = read(files::governance);
  for (const auto* text : {&certificate, &secret, &list, &governance})
    if (!*text) return tl::unexpected(text->error());
  const keys::Identity authority{*certificate, *secret};
  const keys::Validity valid{now - clock_tolerance, now + validity};
  const auto identity = keys::issue(authority, name, valid);
  if (!identity) return tl::unexpected(identity.error());
  const auto facts = keys::facts(identity->certificate);
  if (!facts) return tl::unexpected(facts.error());
  dds::Permissions permissions = dds::min_permissions(role);
  permissions.subject = facts->subject;
  permissions.scope = scope;
  permissions.from = utc(valid.from);
  permissions.until = utc(valid.until);
  const auto permitted = keys::sign(authority, dds::text(permissions));
  if (!permitted) return tl::unexpected(permitted.error());
  fs::create_directories(folder_ / name, code);
  fs::permissions(folder_ / name, fs::perms::owner_all, code);
  for (const auto& [file, text, mode] :
       {std::tuple(files::key, &identity->key, 0600),
        std::tuple(files::certificate, &identity->certificate, 0644),
        std::tuple(files::permissions, &*permitted, 0644),
        std::tuple(files::authority, &*certificate, 0644),
        std::tuple(files::governance, &*governance, 0644),
        std::tuple(files::revoked, &*list, 0644)})
    if (const auto done = write(folder_ / name / file, *text, static_cast<::mode_t>(mode)); !done)
      return done;
  return {};
}

Expected<void> Keystore::revoke(const std::string& name, Time now) const {
  if (!good_name(name)) return fail("is no name for a key", name);
  const auto certificate = read(files::authority), secret = read(authority_key),
             list = read(files::revoked), gone = read(fs::path(name) / files::certificate);
  if (!gone) return fail("there is no key of this name", name, "`prehend keys show` lists them");
  for (const auto* text : {&certificate, &secret, &list})
    if (!*text) return tl::unexpected(text->error());
  const auto facts = keys::facts(*gone);
  if (!facts) return fail(facts.error().what, (folder_ / name / files::certificate).string());
  auto revoked = keys::revoked(*list, *certificate);
  if (!revoked) return fail(revoked.error().what, (folder_ / files::revoked).string());
  for (const keys::Revoked& one : *revoked)
    if (one.serial == facts->serial) return fail("is revoked already", name);
  revoked->push_back({facts->serial, now});
  const auto authority = keys::facts(*certificate);
  if (!authority) return tl::unexpected(authority.error());
  // From now, by clocks that may be behind; until the authority itself ends.
  const auto renewed = keys::revocation_list({*certificate, *secret}, *revoked,
                                             {now - clock_tolerance, authority->valid.until});
  if (!renewed) return tl::unexpected(renewed.error());
  if (const auto done = write(folder_ / files::revoked, *renewed, 0644); !done) return done;
  for (const std::string& one : names())
    if (const auto done = write(folder_ / one / files::revoked, *renewed, 0644); !done) return done;
  return {};
}

Expected<std::vector<Keystore::Entry>> Keystore::entries(Time now) const {
  const auto certificate = read(files::authority), list = read(files::revoked);
  for (const auto* text : {&certificate, &list})
    if (!*text) return tl::unexpected(text->error());
  const auto revoked = keys::revoked(*list, *certificate);
  if (!revoked) return fail(revoked.error().what, (folder_ / files::revoked).string());
  std::vector<Entry> entries;
  for (const std::string& name : names()) {
    Entry entry{.name = name};
    if (const auto own = read(fs::path(name) / files::certificate))
      if (const auto facts = keys::facts(*own)) {
        entry.expires = facts->valid.until;
        entry.revoked = std::any_of(revoked->begin(), revoked->end(),
                                    [&](const auto& one) { return one.serial == facts->serial; });
      }
    if (const auto permitted = read(fs::path(name) / files::permissions))
      if (const auto text = keys::verified(*permitted, *certificate))
        if (auto permissions = dds::read_permissions(*text)) {
          entry.permissions = std::move(*permissions);
          for (const auto& [role, word] : dds::role_names) {
            const dds::Permissions due = dds::min_permissions(role);
            if (due.writes == entry.permissions.writes && due.reads == entry.permissions.reads &&
                (!entry.role || role_of(name) == role))
              entry.role = role;
          }
        }
    if (const auto usable = dds::load_keys(folder_ / name, name, now); !usable)
      entry.trouble = usable.error();
    entries.push_back(std::move(entry));
  }
  return entries;
}

}  // namespace prehend::cli
