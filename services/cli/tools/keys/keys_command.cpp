#include "services/cli/tools/keys/keys_command.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/base/file_text.hpp"
#include "common/base/log.hpp"
#include "common/base/printable.hpp"
#include "common/dds/security.hpp"
#include "common/service/arguments.hpp"
#include "services/cli/tools/keys/keystore.hpp"

namespace prehend::cli {
namespace {

using namespace service;

Time now() {
  return std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
}

std::string day(Time time) {
  return fmt::format("{:%Y-%m-%d}", std::chrono::floor<std::chrono::seconds>(time));
}

std::string_view state_of(const Keystore::Entry& entry) {
  if (entry.revoked) return "revoked";
  if (entry.expires <= now()) return "expired";
  if (entry.trouble) return "broken";
  if (!entry.role) return "outdated";
  if (entry.elsewhere) return "elsewhere";
  return entry.expires - now() < dds::expiry_warning ? "expires soon" : "valid";
}

std::string role_name(const Keystore::Entry& entry) {
  for (const auto& [role, name] : dds::role_names)
    if (entry.role == role) return std::string(name);
  return "-";
}

int show(const Keystore& store, bool json) {
  const auto entries = store.entries(now());
  if (!entries) return complain(entries.error(), exit_broken);
  bool usable = true;
  auto list = nlohmann::ordered_json::array();
  std::string table;
  for (const Keystore::Entry& entry : *entries) {
    const std::string_view state = state_of(entry);
    usable = usable && (state == "valid" || state == "expires soon" || state == "revoked" ||
                        state == "elsewhere");
    list.push_back(
        {{"name", entry.name},
         {"role", role_name(entry)},
         {"state", state},
         {"expires", day(entry.expires)},
         {"rig", entry.permissions.scope.rig},
         {"domain", entry.permissions.scope.domain ? nlohmann::json(*entry.permissions.scope.domain)
                                                   : nlohmann::json()},
         {"trouble", entry.trouble ? entry.trouble->message() : ""},
         {"writes", entry.permissions.writes},
         {"reads", entry.permissions.reads}});
    table +=
        fmt::format("{:<15} {:<12} {:<13} {:<11} {:<27} writes {}\n", entry.name, role_name(entry),
                    state, day(entry.expires), dds::text(entry.permissions.scope),
                    entry.permissions.writes.empty()
                        ? "nothing"
                        : fmt::format("{}", fmt::join(entry.permissions.writes, ", ")));
    if (entry.trouble && !entry.revoked) table += "  " + entry.trouble->message() + "\n";
  }
  std::cout
      << (json ? nlohmann::ordered_json{{"store", store.folder().string()}, {"keys", list}}.dump() +
                     "\n"
               : printable(table, "\n"));
  return usable ? exit_done : exit_no;
}

/// The role that is asked for, or the one in the key's name.
Expected<dds::Role> choose_role(const std::string& name, const std::string& wanted) {
  if (const auto role = dds::role_named(wanted.empty() ? name : wanted)) return *role;
  std::string all;
  for (const auto& [role, word] : dds::role_names) (all += all.empty() ? "" : ", ") += word;
  return fail(wanted.empty() ? "has no role in its name" : "is no role",
              wanted.empty() ? name : "--role " + wanted,
              fmt::format("name the key ROLE or ROLE-something, or give --role: {}", all));
}

struct Arguments {
  std::string folder, name, role, store, rig, file, output;
  LabArguments lab;
  double days = 365;
  bool renew = false, json = false;
  CLI::App *init = nullptr, *add = nullptr, *revoke = nullptr, *shown = nullptr,
           *renew_one = nullptr, *refresh = nullptr, *request = nullptr, *sign = nullptr,
           *install = nullptr;

  void add_to(CLI::App& app) {
    app.require_subcommand(1);
    init = app.add_subcommand("init", "make a keystore in a new folder");
    init->add_option("DIR", folder, "the new folder")->required();
    add = app.add_subcommand("add", "make one more key");
    add->add_option("NAME", name, "a role, or a role and more: viewer-anna")->required();
    add->add_option("--role", role, "its role, when its name does not say it");
    add->add_flag("--renew", renew, "in place of the one of this name");
    revoke = app.add_subcommand("revoke", "no longer vouch for a key");
    revoke->add_option("NAME", name, "of the key")->required();
    renew_one = app.add_subcommand("renew", "the next key of a name, as the one that is there");
    renew_one->add_option("NAME", name, "of the key")->required();
    refresh = app.add_subcommand("refresh", "sign the list of revoked keys anew");
    add_elsewhere_to(app);
    shown = app.add_subcommand("show", "names, roles, permissions and expiry");
    shown->add_flag("--json", json, "one JSON document on standard output");
    for (CLI::App* command : {init, add, sign, renew_one})
      command->add_option("--days", days, "that the keys are valid")
          ->check(CLI::Range(0.001, 3650.0))
          ->capture_default_str();
    for (CLI::App* command : {init, add, sign}) {
      lab.add_to(*command);
      command->add_option("--rig", rig,
                          "the rig where they hold, in lab.domain; otherwise lab.rig; any: in "
                          "every rig and domain");
    }
    for (CLI::App* command : {add, revoke, shown, renew_one, refresh, request, sign, install})
      command->add_option("--store", store, "the keystore; otherwise lab.keys, else ./keys");
  }
  void add_elsewhere_to(CLI::App& app) {
    request = app.add_subcommand("request", "make a key here, and ask an authority elsewhere");
    request->add_option("NAME", name, "a role, or a role and more: viewer-anna")->required();
    sign = app.add_subcommand("sign", "vouch for a key that was made elsewhere");
    sign->add_option("FILE", file, "of `prehend keys request`")->required();
    sign->add_option("--role", role, "its role, when its name does not say it");
    install = app.add_subcommand("install", "take what the authority granted");
    install->add_option("FILE", file, "of `prehend keys sign`")->required();
    for (CLI::App* command : {request, sign})
      command->add_option("--output", output, "the file to write; otherwise standard output");
  }
  Duration validity() const { return seconds(days * 86400); }
};

/// Keys hold where the lab is, unless something else is asked for.
Expected<dds::Scope> choose_scope(const Arguments& arguments) {
  if (arguments.rig == "any") return dds::Scope{};
  const auto config = arguments.lab.load();
  if (!config) return tl::unexpected(config.error());
  return dds::scope_of(arguments.rig.empty() ? config->text("lab.rig") : arguments.rig,
                       static_cast<int>(config->integer("lab.domain")));
}

int init(const Arguments& arguments) {
  const auto scope = choose_scope(arguments);
  if (!scope) return complain(scope.error(), exit_wrong_use);
  const auto made = Keystore::init(arguments.folder, arguments.validity(), now(), *scope);
  if (!made) return complain(made.error(), exit_broken);
  std::cout << fmt::format(
      "Made {0} for {1}. Keep authority-key.pem to yourself. All on this machine:\n"
      "lab.keys = \"{0}\"; elsewhere copy the folder of each process to its host and name that.\n",
      std::filesystem::absolute(arguments.folder).string(), dds::text(*scope));
  return exit_done;
}

int add(const Keystore& store, const Arguments& arguments) {
  const auto role = choose_role(arguments.name, arguments.role);
  if (!role) return complain(role.error(), exit_wrong_use);
  const auto scope = choose_scope(arguments);
  if (!scope) return complain(scope.error(), exit_wrong_use);
  const auto done =
      store.add(arguments.name, *role, arguments.validity(), arguments.renew, now(), *scope);
  if (!done) return complain(done.error(), exit_no);
  log::info("made {} for {}; --rig chooses another", arguments.name, dds::text(*scope));
  return exit_done;
}

int write_out(const std::string& file, const std::string& text) {
  if (file.empty()) {
    std::cout << text;
    return exit_done;
  }
  const auto done = write_file(file, text);
  return done ? exit_done : complain(done.error(), exit_broken);
}

int request(const std::string& store, const Arguments& arguments) {
  const auto made = request_key(store, arguments.name);
  return made ? write_out(arguments.output, *made) : complain(made.error(), exit_no);
}

int install(const std::string& store, const std::string& file) {
  const auto text = read_file(file);
  if (!text) return complain(text.error(), exit_broken);
  auto bundle = Bundle::parse(*text);
  if (!bundle) bundle.error().where = file;
  if (!bundle) return complain(bundle.error(), exit_no);
  const auto folder = install_keys(store, std::move(*bundle), now());
  if (!folder) return complain(folder.error(), exit_no);
  std::cout << "Installed " << folder->string() << ".\n";
  return exit_done;
}

int sign(const Keystore& store, const Arguments& arguments) {
  const auto text = read_file(arguments.file);
  if (!text) return complain(text.error(), exit_broken);
  std::optional<dds::Role> role;
  if (!arguments.role.empty()) {
    const auto chosen = choose_role(arguments.role, arguments.role);
    if (!chosen) return complain(chosen.error(), exit_wrong_use);
    role = *chosen;
  }
  const auto scope = choose_scope(arguments);
  if (!scope) return complain(scope.error(), exit_wrong_use);
  const auto bundle = store.sign(*text, role, arguments.validity(), now(), *scope);
  return bundle ? write_out(arguments.output, bundle->text()) : complain(bundle.error(), exit_no);
}

int revoke(const Keystore& store, const std::string& name) {
  if (const auto done = store.revoke(name, now()); !done) return complain(done.error(), exit_no);
  std::cout << "Copy revoked.pem into the folder of every process on other hosts; services\n"
               "that run join anew by themselves when it changes.\n";
  return exit_done;
}

}  // namespace

int keys_command(const std::vector<std::string>& texts) {
  CLI::App app{
      "Keys with which the processes of a lab know each other. `init` makes an authority and a "
      "key\n"
      "for each role, with the least permissions that it needs, for lab.rig and lab.domain; give\n"
      "each host the folders of the processes that run there and name them in lab.keys\n"
      "(PREHEND_LAB_KEYS). Where private keys shall not travel, `request` on the machine, `sign` "
      "where\nthe authority is, and `install` on the machine. Exit code of show: 0: all can be "
      "used, 1: one is expired, broken or\n"
      "outdated.",
      "prehend keys"};
  Arguments arguments;
  arguments.add_to(app);
  if (const auto code = parse(app, texts)) return *code;
  if (*arguments.init) return init(arguments);
  std::string folder = arguments.store;
  if (folder.empty()) {
    const auto config = arguments.lab.load();
    if (!config) return complain(config.error(), exit_wrong_use);
    folder = config->path("lab.keys").string();
    if (folder.empty()) folder = "keys";
  }
  if (*arguments.request) return request(folder, arguments);
  if (*arguments.install) return install(folder, arguments.file);
  const auto store = Keystore::open(folder);
  if (!store) return complain(store.error(), exit_broken);
  if (*arguments.shown) return show(*store, arguments.json);
  if (*arguments.add) return add(*store, arguments);
  if (*arguments.sign) return sign(*store, arguments);
  if (*arguments.revoke) return revoke(*store, arguments.name);
  const auto done = *arguments.refresh ? store->refresh(now())
                                       : store->renew(arguments.name, arguments.validity(), now());
  return done ? exit_done : complain(done.error(), exit_no);
}

}  // namespace prehend::cli
