#include "services/cli/tools/keys/keys_command.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

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
    usable = usable && (state == "valid" || state == "expires soon" || state == "revoked");
    list.push_back({{"name", entry.name},
                    {"role", role_name(entry)},
                    {"state", state},
                    {"expires", day(entry.expires)},
                    {"trouble", entry.trouble ? entry.trouble->message() : ""},
                    {"writes", entry.permissions.writes},
                    {"reads", entry.permissions.reads}});
    table += fmt::format("{:<16}{:<13}{:<14}{:<12}writes {}\n", entry.name, role_name(entry), state,
                         day(entry.expires),
                         entry.permissions.writes.empty()
                             ? "nothing"
                             : fmt::format("{}", fmt::join(entry.permissions.writes, ", ")));
    if (entry.trouble && !entry.revoked) table += "  " + entry.trouble->message() + "\n";
  }
  std::cout
      << (json ? nlohmann::ordered_json{{"store", store.folder().string()}, {"keys", list}}.dump() +
                     "\n"
               : table);
  return usable ? exit_done : exit_no;
}

/// The role that is asked for, or the one in the key's name.
Expected<dds::Role> choose_role(const std::string& name, const std::string& wanted) {
  if (const auto role = role_of(wanted.empty() ? name : wanted)) return *role;
  std::string all;
  for (const auto& [role, word] : dds::role_names) (all += all.empty() ? "" : ", ") += word;
  return fail("says no role", wanted.empty() ? name : "--role " + wanted,
              fmt::format("name the key ROLE or ROLE-something, or give --role: {}", all));
}

}  // namespace

int keys_command(const std::vector<std::string>& arguments) {
  CLI::App app{
      "Keys with which the processes of a lab know each other. `init` makes an authority and a "
      "key\n"
      "for each role, with the least permissions that it needs; give each host the folders of the\n"
      "processes that run there and name them in lab.keys (PREHEND_LAB_KEYS). Exit code of show: "
      "0:\n"
      "all can be used, 1: one is expired, broken or outdated.",
      "prehend keys"};
  std::string folder, name, role, store_folder;
  double days = 365;
  bool renew = false, json = false;
  app.require_subcommand(1);
  const auto days_option = [&](CLI::App* command) {
    command->add_option("--days", days, "that the keys are valid")
        ->check(CLI::Range(0.001, 3650.0))
        ->capture_default_str();
  };
  auto* init = app.add_subcommand("init", "make a keystore in a new folder");
  init->add_option("DIR", folder, "the new folder")->required();
  days_option(init);
  auto* add = app.add_subcommand("add", "make one more key");
  add->add_option("NAME", name, "a role, or a role and more: viewer-anna")->required();
  add->add_option("--role", role, "its role, when its name does not say it");
  add->add_flag("--renew", renew, "in place of the one of this name");
  days_option(add);
  auto* revoke = app.add_subcommand("revoke", "no longer vouch for a key");
  revoke->add_option("NAME", name, "of the key")->required();
  auto* shown = app.add_subcommand("show", "names, roles, permissions and expiry");
  shown->add_flag("--json", json, "one JSON document on standard output");
  for (CLI::App* command : {add, revoke, shown})
    command->add_option("--store", store_folder, "the keystore; otherwise lab.keys, else ./keys");
  if (const auto code = parse(app, arguments)) return *code;

  if (*init) {
    const auto made = Keystore::init(folder, seconds(days * 86400), now());
    if (!made) return complain(made.error(), exit_broken);
    std::cout << fmt::format(
        "Made {0}. Keep authority-key.pem to yourself. All on this machine: lab.keys = \"{0}\";\n"
        "elsewhere copy the folder of each process to its host and name that.\n",
        std::filesystem::absolute(folder).string());
    return exit_done;
  }
  if (store_folder.empty()) {
    const auto config = LabArguments{}.load();
    if (!config) return complain(config.error(), exit_wrong_use);
    store_folder = config->path("lab.keys").string();
    if (store_folder.empty()) store_folder = "keys";
  }
  const auto store = Keystore::open(store_folder);
  if (!store) return complain(store.error(), exit_broken);
  if (*shown) return show(*store, json);
  Expected<void> done;
  if (*add) {
    const auto chosen = choose_role(name, role);
    if (!chosen) return complain(chosen.error(), exit_wrong_use);
    done = store->add(name, *chosen, seconds(days * 86400), renew, now());
  } else {
    done = store->revoke(name, now());
    if (done)
      std::cout << "Copy revoked.pem into the folder of every process on other hosts; services\n"
                   "that run join anew by themselves when it changes.\n";
  }
  return done ? exit_done : complain(done.error(), exit_no);
}

}  // namespace prehend::cli
