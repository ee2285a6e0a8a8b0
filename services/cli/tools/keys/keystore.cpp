#include "services/cli/tools/keys/keystore.hpp"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <random>
#include <system_error>

#include "common/base/file_text.hpp"
#include "common/dds/security.hpp"

namespace prehend::cli {

namespace fs = std::filesystem;
namespace files = dds::key_files;

namespace {

constexpr const char* name_hint = "small letters, digits, - and _, at most 48";
constexpr const char* authority_key = "authority-key.pem";
constexpr auto authority_validity = std::chrono::days(3650);
constexpr const char* next_key = "next-key.pem";  // asked for, and not yet granted
constexpr std::size_t max_bundle = 1 << 20;       // bytes

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

Expected<void> Bundle::write_to(const fs::path& folder) const {
  std::error_code code;
  fs::create_directories(folder, code);
  fs::permissions(folder, fs::perms::owner_all, code);
  for (const auto& [file, text] : files)
    if (const auto done = write(folder / file, text, file == files::key ? 0600 : 0644); !done)
      return done;
  return {};
}

std::string Bundle::text() const {
  return nlohmann::json{{"name", name}, {"files", files}}.dump(1) + "\n";
}

Expected<Bundle> Bundle::parse(std::string_view text) {
  const auto wrong = [] {
    return fail("is not what `prehend keys sign` writes", {}, "fetch the file again");
  };
  if (text.size() > max_bundle) return wrong();
  const auto document = nlohmann::json::parse(text, nullptr, false);
  if (!document.is_object() || !document.contains("name") || !document["name"].is_string() ||
      !document.contains("files") || !document["files"].is_object())
    return wrong();
  Bundle bundle{document["name"].get<std::string>(), {}};
  if (!good_name(bundle.name)) return wrong();
  for (const char* file : {files::certificate, files::permissions, files::authority,
                           files::governance, files::revoked}) {
    const auto found = document["files"].find(file);
    if (found == document["files"].end() || !found->is_string()) return wrong();
    bundle.files[file] = found->get<std::string>();
  }
  return bundle;
}

Expected<std::string> request_key(const fs::path& store, const std::string& name) {
  if (!good_name(name)) return fail("is no name for a key", name, name_hint);
  const auto made = keys::request(name);
  if (!made) return tl::unexpected(made.error());
  std::error_code code;
  fs::create_directories(store / name, code);
  fs::permissions(store / name, fs::perms::owner_all, code);
  // What is there goes on until the answer is installed.
  if (const auto done = write(store / name / next_key, made->key, 0600); !done)
    return tl::unexpected(done.error());
  return made->text;
}

Expected<fs::path> install_keys(const fs::path& store, Bundle bundle, Time now) {
  const fs::path folder = store / bundle.name, draft = store / (bundle.name + ".new");
  std::error_code code;
  const auto before = read_file(folder / files::authority);
  if (before && *before != bundle.files[files::authority])
    return fail("is of another authority than the keys that are there", folder.string(),
                "remove these first, if that is meant");
  const bool asked = fs::exists(folder / next_key, code);
  const auto key =
      read_file(folder / (asked ? next_key : files::key), "`prehend keys request` makes one");
  if (!key) return tl::unexpected(key.error());
  bundle.files[files::key] = *key;
  fs::remove_all(draft, code);
  const auto written = bundle.write_to(draft);
  const auto good =
      written ? dds::load_keys(draft, bundle.name, now).map([](const auto&) {}) : written;
  fs::remove_all(draft, code);
  if (!good) return tl::unexpected(good.error());
  if (const auto done = bundle.write_to(folder); !done) return tl::unexpected(done.error());
  fs::remove(folder / next_key, code);
  return folder;
}

namespace {

/// What a certificate says beside the name, for the role to be known by it.
std::string_view unit_of(std::string_view name, dds::Role role) {
  return dds::role_named(name) == role ? std::string_view() : dds::name_of(role);
}

}  // namespace

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
  const keys::Validity valid{now - keys::dated_back, now + authority_validity};
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
  if (!good_name(name)) return fail("is no name for a key", name, name_hint);
  std::error_code code;
  if (fs::exists(folder_ / name, code) && !renew) {
    const auto all = entries(now);
    if (!all) return tl::unexpected(all.error());
    for (const Entry& entry : *all)
      if (entry.name == name && !entry.revoked)
        return fail("there is a key of this name", name, "--renew replaces it, or revoke it first");
  }
  const auto authority = identity();
  if (!authority) return tl::unexpected(authority.error());
  const keys::Validity valid{now - keys::dated_back, now + validity};
  const auto identity = keys::issue(*authority, name, unit_of(name, role), valid);
  if (!identity) return tl::unexpected(identity.error());
  auto bundle = bundle_of(name, identity->certificate, role, valid, scope);
  if (!bundle) return tl::unexpected(bundle.error());
  bundle->files[files::key] = identity->key;
  return bundle->write_to(folder_ / name);
}

Expected<keys::Identity> Keystore::identity() const {
  const auto certificate = read(files::authority), secret = read(authority_key);
  for (const auto* text : {&certificate, &secret})
    if (!*text) return tl::unexpected(text->error());
  return keys::Identity{*certificate, *secret};
}

/// What a key comes with: all of its folder but the private key.
Expected<Bundle> Keystore::bundle_of(const std::string& name, const std::string& certificate,
                                     dds::Role role, const keys::Validity& valid,
                                     const dds::Scope& scope) const {
  const auto authority = identity();
  if (!authority) return tl::unexpected(authority.error());
  const auto list = read(files::revoked), governance = read(files::governance);
  for (const auto* text : {&list, &governance})
    if (!*text) return tl::unexpected(text->error());
  const auto facts = keys::facts(certificate);
  if (!facts) return tl::unexpected(facts.error());
  dds::Permissions permissions = dds::min_permissions(role);
  permissions.subject = facts->subject;
  permissions.scope = scope;
  permissions.from = utc(valid.from);
  permissions.until = utc(valid.until);
  const auto permitted = keys::sign(*authority, dds::text(permissions));
  if (!permitted) return tl::unexpected(permitted.error());
  return Bundle{name,
                {{files::certificate, certificate},
                 {files::permissions, *permitted},
                 {files::authority, authority->certificate},
                 {files::governance, *governance},
                 {files::revoked, *list}}};
}

Expected<Bundle> Keystore::sign(const std::string& request, std::optional<dds::Role> role,
                                Duration validity, Time now, const dds::Scope& scope) const {
  const auto name = keys::name_in(request);
  if (!name) return tl::unexpected(name.error());
  if (!good_name(*name)) return fail("asks for a name that is none for a key", *name, name_hint);
  if (!role) role = dds::role_named(*name);
  if (!role) return fail("has no role in its name", *name, "give --role");
  const auto authority = identity();
  if (!authority) return tl::unexpected(authority.error());
  const keys::Validity valid{now - keys::dated_back, now + validity};
  const auto certificate = keys::grant(*authority, request, unit_of(*name, *role), valid);
  if (!certificate) return tl::unexpected(certificate.error());
  auto bundle = bundle_of(*name, *certificate, *role, valid, scope);
  if (!bundle) return bundle;
  // So that it is listed, and can be revoked.
  if (const auto kept = bundle->write_to(folder_ / *name); !kept)
    return tl::unexpected(kept.error());
  std::error_code code;
  fs::remove(folder_ / *name / files::key, code);  // of one that was made here before
  return bundle;
}

Expected<void> Keystore::renew(const std::string& name, Duration validity, Time now) const {
  const auto all = entries(now);
  if (!all) return tl::unexpected(all.error());
  const auto found = std::ranges::find(*all, name, &Entry::name);
  if (found == all->end())
    return fail("there is no key of this name", name, "`prehend keys show` lists them");
  if (found->elsewhere)
    return fail("its private key is elsewhere", name, "there: prehend keys request " + name);
  if (!found->role)
    return fail("has the permissions of no role any more", name, "keys add --renew --role");
  return add(name, *found->role, validity, true, now, found->permissions.scope);
}

Expected<void> Keystore::write_list(std::vector<keys::Revoked> revoked, Time now) const {
  const auto by = identity();
  if (!by) return tl::unexpected(by.error());
  const auto authority = keys::facts(by->certificate);
  if (!authority) return tl::unexpected(authority.error());
  // From now, by clocks that may be behind; until the authority itself ends.
  const auto list =
      keys::revocation_list(*by, revoked, {now - keys::dated_back, authority->valid.until});
  if (!list) return tl::unexpected(list.error());
  if (const auto done = write(folder_ / files::revoked, *list, 0644); !done) return done;
  for (const std::string& one : names())
    if (const auto done = write(folder_ / one / files::revoked, *list, 0644); !done) return done;
  return {};
}

Expected<void> Keystore::refresh(Time now) const {
  const auto certificate = read(files::authority), list = read(files::revoked);
  for (const auto* text : {&certificate, &list})
    if (!*text) return tl::unexpected(text->error());
  auto revoked = keys::revoked(*list, *certificate);
  if (!revoked) return fail(revoked.error().what, (folder_ / files::revoked).string());
  return write_list(std::move(*revoked), now);
}

Expected<void> Keystore::revoke(const std::string& name, Time now) const {
  if (!good_name(name)) return fail("is no name for a key", name, "`prehend keys show` lists them");
  const auto certificate = read(files::authority), list = read(files::revoked),
             gone = read(fs::path(name) / files::certificate);
  if (!gone) return fail("there is no key of this name", name, "`prehend keys show` lists them");
  for (const auto* text : {&certificate, &list})
    if (!*text) return tl::unexpected(text->error());
  const auto facts = keys::facts(*gone);
  if (!facts) return fail(facts.error().what, (folder_ / name / files::certificate).string());
  auto revoked = keys::revoked(*list, *certificate);
  if (!revoked) return fail(revoked.error().what, (folder_ / files::revoked).string());
  for (const keys::Revoked& one : *revoked)
    if (one.serial == facts->serial) return fail("is revoked already", name);
  revoked->push_back({facts->serial, now});
  return write_list(std::move(*revoked), now);
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
                (!entry.role || dds::role_named(name) == role))
              entry.role = role;
          }
        }
    std::error_code code;
    entry.elsewhere = !fs::exists(folder_ / name / files::key, code);
    if (const auto usable = dds::load_keys(folder_ / name, name, now); !usable && !entry.elsewhere)
      entry.trouble = usable.error();
    entries.push_back(std::move(entry));
  }
  return entries;
}

}  // namespace prehend::cli
