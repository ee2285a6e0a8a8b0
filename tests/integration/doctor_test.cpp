// prehend doctor: each check is shown the real fault and must name it, with a mend; without a fault
// it must be silent. Faults of the network and of shared memory are made in namespaces of their
// own, which takes root; those are skipped without.
#include <sys/stat.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "common/dds/raw.hpp"
#include "services/cli/tools/keys/keystore.hpp"
#include "tests/integration/rig.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::integration {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class Doctor : public Rig {
 protected:
  /// Names of the checks that found something, from the document.
  static std::map<std::string, std::string> faults(const Answer& answer) {
    std::map<std::string, std::string> found;
    const Json document = Json::parse(answer.output, nullptr, false);
    if (document.is_discarded()) {
      ADD_FAILURE() << "no document: " << answer.output << answer.log;
      return found;
    }
    for (const Json& check : document["checks"]) {
      if (check["ok"].get<bool>()) continue;
      found[check["name"]] = check["detail"];
      EXPECT_NE(check["mend"], "") << check;
    }
    EXPECT_EQ(answer.exit_code, found.empty() ? 0 : 1) << answer.output;
    return found;
  }
  std::map<std::string, std::string> ask(const Strings& sets = {}, Strings more = {}) {
    Strings arguments = with_lab({"doctor", "--json", "--listen", "1.5"});
    for (const std::string& set : sets) arguments.insert(arguments.end(), {"--set", set});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return faults(run("prehend", arguments, 60));
  }
  /// The doctor in a script of a machine of its own: no interfaces but those it makes, no shared
  /// memory but its own.
  std::map<std::string, std::string> ask_in_script(const std::string& script) {
    const std::string file = (folder_ / "script").string();
    std::string lab;
    for (const std::string& word : with_lab({})) (lab += word) += " ";
    std::ofstream(file) << "bin=" << test::in_programs("") << "\nmount -t tmpfs none /dev/shm\n"
                        << "doctor=\"$bin/prehend doctor --json --listen 1 " << lab << "\"\n"
                        << script;
    stage::Process::Options options;
    options.command = {"unshare", "-n", "-m", "-i", "sh", file};
    const std::string name = "script-" + std::to_string(++scripts_);
    options.log = folder_ / (name + ".log");
    options.output = folder_ / (name + ".out");
    auto process = stage::Process::start(options);
    if (!process) throw std::runtime_error(process.error().message());
    const auto exit = process->wait(seconds(60));
    process->stop(seconds(5));
    const auto text = [](const fs::path& path) {
      std::ifstream stream(path);
      return std::string(std::istreambuf_iterator<char>(stream), {});
    };
    return faults({exit ? exit->code : -1, text(options.output), text(options.log)});
  }
  int scripts_ = 0;

  static bool may_make_namespaces() {
    return std::system(
               "unshare -n -m -i sh -c 'mount -t tmpfs none /dev/shm && ip link set lo up' "
               ">/dev/null 2>&1") == 0;
  }
};

TEST_F(Doctor, FindsNothingWhereNothingIsWrong) {
  if (!may_make_namespaces()) GTEST_SKIP() << "namespaces need root and ip";
  const auto found = ask_in_script("ip link set lo up; exec $doctor");
  EXPECT_TRUE(found.empty()) << found.begin()->first << ": " << found.begin()->second;
}

TEST_F(Doctor, NamesAMissingInterfaceAndBlockedMulticast) {
  if (!may_make_namespaces()) GTEST_SKIP() << "namespaces need root and ip";
  EXPECT_TRUE(ask_in_script("exec $doctor").contains("interface"));
  // An interface, but nothing leads to the multicast group.
  const auto found = ask_in_script(R"(
ip link set lo up; ip link add outside type veth peer name cable
ip link set outside up; ip link set cable up; ip addr add 10.9.0.1/24 dev outside
ip link set outside multicast off
exec $doctor --set lab.network=lan)");
  EXPECT_TRUE(found.contains("multicast"));
  EXPECT_FALSE(found.contains("interface"));
  // And a firewall that lets none in.
  if (std::system("unshare -n iptables -A INPUT -d 239.255.0.1 -j DROP >/dev/null 2>&1") == 0) {
    EXPECT_TRUE(ask_in_script("ip link set lo up; iptables -A INPUT -d 239.255.0.1 -j DROP; "
                              "exec $doctor")
                    .contains("multicast"));
  }
}

TEST_F(Doctor, NamesSharedMemoryThatIsLeftOverOrOutOfReach) {
  if (!may_make_namespaces()) GTEST_SKIP() << "namespaces need root and ip";
  const std::string peer = R"(
ip link set lo up
$bin/shared_memory_peer 3 >/tmp/ready.$$ & peer=$!
until grep -q ready /tmp/ready.$$; do sleep 0.05; done; rm /tmp/ready.$$
)";
  auto found = ask_in_script(peer + "unshare -i $doctor; code=$?; kill $peer; exit $code");
  EXPECT_TRUE(found.contains("ipc namespaces"));
  EXPECT_FALSE(found.contains("stale shared memory"));
  found = ask_in_script(peer + "$doctor; code=$?; kill $peer; exit $code");
  EXPECT_FALSE(found.contains("ipc namespaces"));
  EXPECT_FALSE(found.contains("users"));
  found = ask_in_script(peer + "kill -9 $peer; wait $peer; exec $doctor");
  EXPECT_TRUE(found.contains("stale shared memory"));
  found = ask_in_script(
      std::string(peer).replace(peer.find("$bin"), 0, "setpriv --reuid=65534 --clear-groups ") +
      "$doctor; code=$?; kill $peer; exit $code");
  EXPECT_TRUE(found.contains("users"));
}

TEST_F(Doctor, NamesWhatInTheEnvironmentWouldChangeDds) {
  if (!may_make_namespaces()) GTEST_SKIP() << "namespaces need root and ip";
  auto found =
      ask_in_script("ip link set lo up; export ROS_DISCOVERY_SERVER=10.0.0.1:11811; exec $doctor");
  EXPECT_TRUE(found.contains("environment"));
  found = ask_in_script("ip link set lo up; cd " + folder_.string() + "; touch " +
                        dds::profiles_file + "; exec $doctor");
  EXPECT_TRUE(found.contains("environment"));
}

TEST_F(Doctor, NamesABrokenProfileAndWhatFollows) {
  fs::create_directories(folder_ / "share" / "dds");
  std::ofstream(folder_ / "share" / "dds" / "laptop.xml") << "<dds/>";
  stage::Process::Options options;
  options.command = {program("prehend")};
  for (const std::string& word :
       with_lab({"doctor", "--json", "--config", test::in_sources("deploy/lab.toml")}))
    options.command.push_back(word);
  options.output = folder_ / "doctor.out";
  options.log = folder_ / "doctor.log";
  options.environment = {{"PREHEND_SHARE", (folder_ / "share").string()}};
  auto process = stage::Process::start(options);
  ASSERT_TRUE(process);
  const auto exit = process->wait(seconds(30));
  std::ifstream stream(options.output);
  const auto found =
      faults({exit ? exit->code : -1, {std::istreambuf_iterator<char>(stream), {}}, ""});
  EXPECT_TRUE(found.contains("profile"));
  EXPECT_TRUE(found.contains("joining the lab"));
}

TEST_F(Doctor, NamesAWrongRigAndAWrongDomain) {
  auto simulation = start("simulation");
  auto statuses = reader(dds::service_status);
  ASSERT_TRUE(hear<v1::ServiceStatus>(statuses, 15, [](const auto&) { return true; }));
  participant_.reset();
  auto found = ask();
  EXPECT_FALSE(found.contains("rig"));
  EXPECT_FALSE(found.contains("domain"));
  found = ask({"lab.rig=another"});
  EXPECT_NE(found["rig"].find(name_), std::string::npos) << found["rig"];
  const test::DomainLease nobodys;
  found = ask({"lab.domain=" + std::to_string(nobodys.domain())});
  EXPECT_NE(found["domain"].find(std::to_string(domain_)), std::string::npos) << found["domain"];
}

TEST_F(Doctor, NamesAnotherVersionsTypes) {
  auto writer = dds::RawWriter::create(
      *participant_, {"object/detection", "prehend::v2::ObjectDetection", true, {}});
  ASSERT_TRUE(writer);
  EXPECT_NE(ask()["types"].find("v2"), std::string::npos);
}

TEST_F(Doctor, NamesADiscoveryServerThatDoesNotAnswer) {
  const Strings sets{"lab.network=server", "lab.server=[\"" + address() + "\"]"};
  EXPECT_TRUE(ask(sets).contains("discovery server"));
  auto server = start_program("prehend", with_lab({"discovery-server", "--listen", address()}));
  EXPECT_TRUE(eventually(20, [&] { return !ask(sets).contains("discovery server"); }));
}

TEST_F(Doctor, NamesASiteThatTakesNoCalls) {
  if (!may_make_namespaces()) GTEST_SKIP() << "namespaces need root and ip";
  const std::string dial =
      "$doctor --set lab.network=wan --set lab.insecure=true --set "
      "'lab.peers=[\"127.0.0.1:7420\"]'";
  const std::string up = "ip link set lo up; ip link set lo multicast on; ";
  EXPECT_NE(ask_in_script(up + "exec " + dial)["sites"].find("127.0.0.1:7420"), std::string::npos);
  std::string lab;
  for (const std::string& word : with_lab({})) (lab += word) += " ";
  const std::string listens = "$bin/prehend-simulation " + lab +
                              "--set lab.network=wan --set lab.insecure=true & peer=$!\n"
                              "until bash -c 'exec 3<>/dev/tcp/127.0.0.1/7420' 2>/dev/null; "
                              "do sleep 0.05; done\n";
  EXPECT_FALSE(ask_in_script(up + listens + dial + "; code=$?; kill $peer; wait $peer; exit $code")
                   .contains("sites"));
}

// A service on another host, by the kernel's name, whose clock is an hour behind.
TEST_F(Doctor, NamesAServiceWhoseHostHasAnotherTime) {
  const std::string faketime = "/usr/lib/x86_64-linux-gnu/faketime/libfaketimeMT.so.1";
  if (!may_make_namespaces()) GTEST_SKIP() << "namespaces need root and ip";
  if (!fs::exists(faketime)) GTEST_SKIP() << "libfaketime is not installed";
  stage::Process::Options options;
  options.command = {"unshare",
                     "--uts",
                     "sh",
                     "-c",
                     "hostname elsewhere; exec \"$@\"",
                     "sh",
                     program("prehend-simulation")};
  for (const std::string& word : lab_arguments()) options.command.push_back(word);
  options.environment = {
      {"LD_PRELOAD", faketime}, {"FAKETIME", "-3600s"}, {"FAKETIME_DONT_FAKE_MONOTONIC", "1"}};
  options.log = folder_ / "simulation.log";
  auto simulation = stage::Process::start(options);
  ASSERT_TRUE(simulation);
  std::map<std::string, std::string> found;
  ASSERT_TRUE(eventually(20, [&] { return (found = ask()).contains("clocks"); }));
  EXPECT_NE(found.at("clocks").find("elsewhere"), std::string::npos) << found.at("clocks");
  EXPECT_NE(found.at("clocks").find("behind"), std::string::npos) << found.at("clocks");
}

// A status with the stamp that another host's clock would give it.
TEST_F(Doctor, NamesAHostWhoseClockIsWrong) {
  auto statuses = writer(dds::service_status);
  std::atomic<bool> over = false;
  std::thread other([&] {
    for (std::uint64_t n = 0; !over; ++n) {
      v1::ServiceStatus status;
      status.service("mapping@elsewhere/1");
      status.host("elsewhere");
      status.name("mapping");
      dds::rtps::WriteParams parameters;
      dds::rtps::Time_t stamp;
      stamp.from_ns(now_ns() - 3'600'000'000'000);
      parameters.source_timestamp(stamp);
      statuses.raw().write(&status, parameters);
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  });
  const auto found = ask();
  over = true;
  other.join();
  ASSERT_TRUE(found.contains("clocks"));
  EXPECT_NE(found.at("clocks").find("elsewhere"), std::string::npos);
}

// Liveness hangs on nothing but the process: no network, no discovery server, no keys.
TEST_F(Doctor, AServiceAnswersForItself) {
  const auto alive = [&](const std::string& timeout) {
    return run("prehend",
               with_lab({"alive", "simulation", "--timeout", timeout, "--set", "lab.network=server",
                         "--set", "lab.keys=/none"}),
               20)
        .exit_code;
  };
  EXPECT_EQ(alive("1"), 1);
  auto simulation = start("simulation");
  EXPECT_TRUE(eventually(20, [&] { return alive("1") == 0; }));
  EXPECT_EQ(run("prehend", with_lab({"alive", "mapping", "--timeout", "1"}), 20).exit_code, 1);
  simulation.signal(SIGSTOP);
  EXPECT_TRUE(eventually(20, [&] { return alive("0.3") == 1; })) << "it hangs";
  simulation.signal(SIGCONT);
  EXPECT_TRUE(eventually(20, [&] { return alive("1") == 0; }));
  simulation.stop(seconds(5));
  EXPECT_EQ(alive("1"), 1);
}

TEST_F(Doctor, NamesASecuredPeerBesideAnUnsecuredOneAndTheReverse) {
  const Time now = from_ns(now_ns());
  const auto store = cli::Keystore::init(folder_ / "keys", std::chrono::days(365), now, {});
  ASSERT_TRUE(store);
  const std::string secured = "lab.keys=" + store->folder().string();
  EXPECT_TRUE(ask({secured}).contains("security")) << "this test is there without keys";
  participant_.reset();
  EXPECT_FALSE(ask({secured}).contains("security"));
  auto simulation = start("simulation", {secured});
  EXPECT_TRUE(eventually(15, [&] { return ask().contains("security"); }));
}

TEST_F(Doctor, NamesKeysThatAreOpenOrAboutToExpire) {
  const Time now = from_ns(now_ns());
  const auto store = cli::Keystore::init(folder_ / "keys", std::chrono::days(10), now, {});
  ASSERT_TRUE(store);
  const std::string keys = "lab.keys=" + (store->folder() / "viewer").string();
  EXPECT_NE(ask({keys})["keys"].find("10 days"), std::string::npos);
  ASSERT_TRUE(store->add("viewer", dds::Role::viewer, std::chrono::days(100), true, now, {}));
  EXPECT_FALSE(ask({keys}).contains("keys"));
  fs::permissions(store->folder() / "viewer" / "key.pem", fs::perms::others_read,
                  fs::perm_options::add);
  EXPECT_NE(ask({keys})["keys"].find("read by others"), std::string::npos);
}

TEST_F(Doctor, NamesTheGroupOfADeviceAndALibraryThatIsMissing) {
  if (!may_make_namespaces()) GTEST_SKIP() << "namespaces need root and ip";
  // Even root may not, without its powers.
  const auto closed = ask_in_script(R"(
ip link set lo up; port=/dev/shm/tracker; mknod $port c 4 64; chown 65534:dialout $port; chmod 660 $port
exec setpriv --clear-groups --bounding-set=-all --inh-caps=-all $doctor --set glove.port=$port)");
  ASSERT_TRUE(closed.contains("devices"));
  EXPECT_NE(closed.at("devices").find("dialout"), std::string::npos) << closed.at("devices");
  // Nothing where a library of the simulation alone was.
  const auto broken = ask_in_script(R"sh(
ip link set lo up
mount --bind /dev/null "$(ldd $bin/prehend-simulation | awk '/libBulletDynamics/ {print $3}')"
exec $doctor)sh");
  ASSERT_TRUE(broken.contains("programs"));
  EXPECT_NE(broken.at("programs").find("Bullet"), std::string::npos) << broken.at("programs");
}

TEST_F(Doctor, NamesDevicesThatCannotBeOpenedAndProgramsThatAreMissing) {
  EXPECT_TRUE(ask({"glove.port=/dev/prehend-no-such-port"}).contains("devices"));
  fs::create_directories(folder_ / "bin");
  fs::copy(program("prehend"), folder_ / "bin" / "prehend");
  stage::Process::Options options;
  options.command = {(folder_ / "bin" / "prehend").string()};
  for (const std::string& word : with_lab({"doctor", "--json", "--listen", "0.5"}))
    options.command.push_back(word);
  options.output = folder_ / "doctor.out";
  options.environment = {{"PREHEND_SHARE", test::in_share("")}};
  auto process = stage::Process::start(options);
  ASSERT_TRUE(process);
  const auto exit = process->wait(seconds(30));
  std::ifstream stream(options.output);
  const auto found =
      faults({exit ? exit->code : -1, {std::istreambuf_iterator<char>(stream), {}}, ""});
  EXPECT_TRUE(found.contains("programs"));
}

}  // namespace
}  // namespace prehend::integration
