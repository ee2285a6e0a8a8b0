#include "services/cli/tools/doctor/machine.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <grp.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>

#include "common/base/paths.hpp"
#include "common/dds/network.hpp"
#include "common/dds/security.hpp"
#include "common/service/membership.hpp"
#include "common/stage/process.hpp"
#include "common/stage/temporary_folder.hpp"

namespace prehend::cli {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view memory_folder = "/dev/shm";

/// A file of it there, of either release: 2.9 calls them otherwise than 3.1.
bool is_of_fast_dds(std::string_view name) {
  return name.starts_with("fastrtps_") || name.starts_with("fastdds_");
}

Check fault(std::string name, std::string detail, std::string hint) {
  return {std::move(name), false, std::move(detail), std::move(hint)};
}

/// A process that has mapped shared memory of Fast DDS.
struct Sharer {
  int pid = 0;
  std::string program, ipc_namespace;
};

/// Shared memory of Fast DDS, which keeps a lock on a file beside each segment and port in use.
struct Segment {
  bool in_use = false;
  ::uid_t user = 0;
};

std::vector<Segment> segments() {
  std::vector<Segment> found;
  std::error_code code;
  for (const auto& entry : fs::directory_iterator(memory_folder, code)) {
    const std::string name = entry.path().filename();
    if (!is_of_fast_dds(name) || !name.ends_with("_el")) continue;
    struct ::stat status {};
    const int file = ::open(entry.path().c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0 || ::fstat(file, &status) != 0) continue;
    found.push_back({::flock(file, LOCK_EX | LOCK_NB) != 0, status.st_uid});
    ::close(file);
  }
  return found;
}

std::vector<Sharer> sharers() {
  std::vector<Sharer> found;
  std::error_code code;
  for (const auto& entry : fs::directory_iterator("/proc", code)) {
    const std::string name = entry.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    std::ifstream maps(entry.path() / "maps");
    for (std::string line; std::getline(maps, line);) {
      const auto at = line.find(memory_folder);
      if (at == std::string::npos ||
          !is_of_fast_dds(std::string_view(line).substr(at + memory_folder.size() + 1)))
        continue;
      std::string program;
      std::getline(std::ifstream(entry.path() / "comm"), program);
      found.push_back(
          {std::stoi(name), program, fs::read_symlink(entry.path() / "ns/ipc", code).string()});
      break;
    }
  }
  return found;
}

/// May this process read and write the device?
std::optional<std::string> closed(const fs::path& device) {
  if (::access(device.c_str(), R_OK | W_OK) == 0) return std::nullopt;
  struct ::stat status {};
  if (::stat(device.c_str(), &status) != 0) return fmt::format("{} is not there", device.string());
  const ::group* group = ::getgrgid(status.st_gid);
  return fmt::format("{} may only be used by the group {}", device.string(),
                     group ? group->gr_name : std::to_string(status.st_gid));
}

}  // namespace

Check check_environment() {
  const auto influences = dds::environment_overrides();
  if (influences.empty()) return {"environment", true, "nothing changes DDS from outside", ""};
  std::string detail, hint;
  for (const Error& influence : influences) {
    (detail += detail.empty() ? "" : "; ") += influence.where + " " + influence.what;
    (hint += hint.empty() ? "" : "; ") += influence.hint;
  }
  return fault("environment", detail, hint);
}

Check check_profile(const service::Config& config) {
  const dds::ParticipantOptions lab = service::membership(config, "doctor");
  const auto qos = dds::participant_qos(lab.network);
  if (!qos) return fault("profile", qos.error().message(), qos.error().hint);
  return {"profile", true, lab.network.profile, ""};
}

Check check_interface(const service::Config& config) {
  const bool laptop = config.text("lab.network") == "laptop";
  ifaddrs* all = nullptr;
  std::string usable;
  if (::getifaddrs(&all) == 0) {
    for (const ifaddrs* one = all; one; one = one->ifa_next)
      if (one->ifa_addr && one->ifa_addr->sa_family == AF_INET && (one->ifa_flags & IFF_UP) &&
          laptop == bool(one->ifa_flags & IFF_LOOPBACK))
        (usable += usable.empty() ? "" : ", ") += one->ifa_name;
    ::freeifaddrs(all);
  }
  if (!usable.empty()) return {"interface", true, usable, ""};
  return laptop ? fault("interface", "the loopback interface is down", "ip link set lo up")
                : fault("interface", "no interface but loopback is up with an IPv4 address",
                        "connect the network, or use lab.network = laptop");
}

Check check_keys(const service::Config& config, Time now) {
  const fs::path folder = config.path("lab.keys");
  if (folder.empty()) return {"keys", true, "this lab is not secured (lab.keys is empty)", ""};
  const auto keys = dds::load_keys(folder, "viewer", now);
  if (!keys) return fault("keys", keys.error().message(), keys.error().hint);
  const double days = to_seconds(keys->expires - now) / 86400;
  const std::string detail = fmt::format("{} is valid for {:.0f} days", keys->subject, days);
  if (keys->expires - now < dds::expiry_warning)
    return fault("keys", detail, "prehend keys renew, and copy the folder");
  if (const auto old =
          dds::old_list(*keys, seconds(86400 * config.number("keys.revocation_max_age")), now))
    return fault("keys", old->what, old->hint);
  return {"keys", true, detail, ""};
}

Check check_consent(const service::Config& config) {
  const bool given = config.is_given("safety.deadman"), asks = config.flag("safety.deadman");
  if (given && !asks)
    return {"consent", true, "no robot waits for consent, not even a real one (safety.deadman)",
            ""};
  if (asks) return {"consent", true, "every hand moves only with consent (safety.deadman)", ""};
  return {"consent", true, "a real robot moves only with consent, others without", ""};
}

Check check_stale_memory() {
  const auto all = segments();
  const auto stale = std::count_if(all.begin(), all.end(), [](auto& one) { return !one.in_use; });
  if (stale == 0) return {"stale shared memory", true, "none", ""};
  return fault("stale shared memory",
               fmt::format("{} segments in {} of DDS programs that are gone", stale, memory_folder),
               "fastdds shm clean");
}

Check check_ipc_namespaces() {
  std::error_code code;
  const std::string own = fs::read_symlink("/proc/self/ns/ipc", code).string();
  for (const Sharer& sharer : sharers())
    if (sharer.ipc_namespace != own)
      return fault("ipc namespaces",
                   fmt::format("{} ({}) uses DDS over shared memory in another IPC namespace: what "
                               "shares memory is found there but hears nothing from here",
                               sharer.program, sharer.pid),
                   "run it with one of our profiles (UDP only), or both with --ipc=host");
  return {"ipc namespaces", true, "nobody shares memory across them", ""};
}

Check check_users() {
  for (const Segment& segment : segments())
    if (segment.in_use && segment.user != ::geteuid())
      return fault(
          "users",
          fmt::format("user {} uses DDS over shared memory, this is user {}: such programs "
                      "find but do not hear each other",
                      segment.user, ::geteuid()),
          "run both as one user, or with one of our profiles (UDP only)");
  return {"users", true, "nobody shares memory across them", ""};
}

Check check_programs() {
  auto folder = stage::TemporaryFolder::create(false);
  if (!folder) return fault("programs", folder.error().message(), folder.error().hint);
  std::string trouble;
  for (const char* name :
       {"glove", "recognition", "mapping", "planner", "simulation", "record", "replay"}) {
    const fs::path program = program_directory() / (std::string("prehend-") + name);
    const fs::path log = folder->path() / name;
    auto process = stage::Process::start(
        {.command = {program.string(), "--help"}, .log = log, .output = "/dev/null"});
    const auto exit = process ? process->wait(seconds(20)) : std::nullopt;
    if (exit && exit->code == 0) continue;
    const std::string said = stage::last_lines(log, 1);
    (trouble += trouble.empty() ? "" : "; ") +=
        fmt::format("prehend-{}: {}", name, said.empty() ? "cannot be started" : said);
  }
  if (trouble.empty()) return {"programs", true, "all services can be started", ""};
  return fault("programs", trouble, "apt install ./prehend*.deb, or deploy/install-dependencies");
}

Check check_devices(const service::Config& config) {
  std::string trouble;
  for (const char* key : {"glove.port", "glove.wrist_port", "recognition.path"})
    if (const std::string device = config.text(key); device.starts_with("/dev/"))
      if (const auto why = closed(device)) (trouble += trouble.empty() ? "" : "; ") += *why;
  if (trouble.empty()) return {"devices", true, "what is configured can be opened", ""};
  return fault("devices", trouble,
               "plug it in; add yourself to its group (dialout for ports, video for cameras): "
               "usermod -aG GROUP USER, then log in anew");
}

}  // namespace prehend::cli
