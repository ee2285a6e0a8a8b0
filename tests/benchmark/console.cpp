// What the console costs: a lab of 40 bodies that move at 60 Hz is watched by clients of this
// process.
//
//   benchmark_console [--seconds S] [--lab] [--turns N] [--visits S] [--hold S]
//
// --lab: what 10 clients add to the latency from glove to world, with and without them in four
// turns, or more. The lab tells the latency of its last 1024 frames, so a turn is to last longer
// than these: 35 s, so all of it not quite three minutes.
// --visits: only the memory, while 50 clients at a time come and go that long.
// --hold: prints the address and moves bodies and a hand that long, for who wants to look.
// A floor is measured beside each figure: what the machine takes at that time to hand as many bytes
// from one thread to another through a socket.
#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <ctime>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/base/paths.hpp"
#include "common/dds/participant.hpp"
#include "common/stage/lab.hpp"
#include "common/stage/temporary_folder.hpp"
#include "tests/integration/web_client.hpp"
#include "tests/support/domains/domain_lease.hpp"

namespace prehend {
namespace {

using namespace std::chrono_literals;
using integration::WebClient;
using nlohmann::ordered_json;

constexpr int bodies = 40;
constexpr double rate = 60;  // Hz

std::int64_t now_ns() {
  return to_ns(std::chrono::system_clock::now());
}

[[noreturn]] void give_up(const std::string& why) {
  std::cerr << why << "\n";
  std::exit(3);
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
}

struct Place {
  test::DomainLease lease;
  int domain = lease.domain();
  std::string rig = fmt::format("console-{}", ::getpid());
};

/// The console as a process, and what it takes.
class Console {
 public:
  Console(const Place& place, const std::filesystem::path& folder) {
    const auto output = folder / "address";
    auto made = stage::Process::start(
        {.command = {(program_directory() / "prehend-console").string(), "--set", "console.port=0",
                     "--set", "lab.rig=" + place.rig, "--set",
                     fmt::format("lab.domain={}", place.domain)},
         .log = folder / "console.log",
         .output = output});
    if (!made) give_up(made.error().message());
    process_.emplace(std::move(*made));
    for (int i = 0; i < 1500 && port_ == 0; ++i) {
      std::this_thread::sleep_for(20ms);
      std::ifstream said(output);
      if (std::getline(said, address_) && !said.eof())
        port_ = std::stoi(address_.substr(address_.rfind(':') + 1));
    }
    if (port_ == 0) give_up(stage::last_lines(folder / "console.log", 5));
  }
  int port() const { return port_; }
  const std::string& address() const { return address_; }

  /// Processor time so far, s.
  double used() const {
    clockid_t clock{};
    timespec time{};
    if (::clock_getcpuclockid(process_->pid(), &clock) != 0 || ::clock_gettime(clock, &time) != 0)
      give_up("the console has ended");
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }
  double memory_mb() const {
    std::ifstream file(fmt::format("/proc/{}/statm", process_->pid()));
    double all = 0, resident = 0;
    file >> all >> resident;
    return resident * static_cast<double>(::sysconf(_SC_PAGESIZE)) / 1e6;
  }

 private:
  std::optional<stage::Process> process_;
  int port_ = 0;
  std::string address_;
};

/// Moves the bodies, a hand with them, and on request pictures that fill the sockets of who does
/// not read.
class Mover {
 public:
  explicit Mover(const Place& place) {
    auto made = dds::Participant::create(
        {.name = "simulation", .domain = place.domain, .rig = place.rig, .network = {}});
    if (!made) give_up(made.error().message());
    participant_.emplace(std::move(*made));
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }
  std::atomic<bool> pictures = false;

 private:
  void run(const std::stop_token& stop) {
    auto objects = *participant_->writer(dds::object_state);
    auto hands = *participant_->writer(dds::robot_state);
    auto images = *participant_->writer(dds::camera_image);
    v1::CameraImage image;
    image.camera("camera");
    image.encoding("jpeg");
    image.data(std::vector<std::uint8_t>(56'000, 7));
    auto next = std::chrono::steady_clock::now();
    for (int i = 0; !stop.stop_requested(); ++i) {
      next += std::chrono::nanoseconds(static_cast<long>(1e9 / rate));
      std::this_thread::sleep_until(next);
      const double angle = 0.02 * i;
      v1::ObjectState state;
      state.X_WO().orientation().w(1);
      for (int body = 0; body < bodies; ++body) {
        state.body(fmt::format("body-{}", body).c_str());
        state.stamp_ns(now_ns());
        state.X_WO().position().x(std::sin(angle + body));
        objects.write(state);
      }
      v1::HandState hand;
      hand.hand("hand");
      hand.model("barrett");
      hand.dof({0.1, 0.7 + 0.5 * std::sin(angle), 0.7, 0.7});
      hand.X_WB().position().z(0.3);
      hand.X_WB().orientation().w(1);
      hand.stamp_ns(now_ns());
      hands.write(hand);
      image.stamp_ns(now_ns());
      if (pictures) images.write(image);
    }
  }

  std::optional<dds::Participant> participant_;
  std::jthread thread_;
};

/// Subscribes topics by name.
bool subscribe(WebClient& client, const std::vector<std::string>& topics) {
  const auto told = client.hear_until(20, [](const WebClient::Message& message) {
    return !message.binary && message.bytes.find("\"advertise\"") != std::string::npos;
  });
  if (!told) return false;
  ordered_json asked{{"op", "subscribe"}, {"subscriptions", ordered_json::array()}};
  const ordered_json all = ordered_json::parse(told->bytes);
  for (const auto& channel : all["channels"])
    if (std::find(topics.begin(), topics.end(), channel["topic"].get<std::string>()) !=
        topics.end())
      asked["subscriptions"].push_back({{"id", channel["id"]}, {"channelId", channel["id"]}});
  client.say(asked.dump());
  return true;
}

/// The integer behind each such name in a JSON text.
std::vector<std::int64_t> numbers_behind(std::string_view text, std::string_view name) {
  std::vector<std::int64_t> found;
  for (std::size_t at = text.find(name); at != std::string_view::npos; at = text.find(name, at)) {
    at += name.size();
    std::int64_t number = 0;
    std::from_chars(text.data() + at, text.data() + text.size(), number);
    found.push_back(number);
  }
  return found;
}

/// A client in a thread of its own; a message is as old as the oldest of the frames in it.
class Watcher {
 public:
  explicit Watcher(int port)
      : client_(port, "foxglove.sdk.v1"),
        thread_([this](const std::stop_token& stop) { run(stop); }) {}
  struct Seen {
    std::vector<double> ages;  // ms
    std::size_t frames = 0;
  };
  Seen stop() {
    thread_.request_stop();
    thread_.join();
    return std::move(seen_);
  }

 private:
  void run(const std::stop_token& stop) {
    if (!subscribe(client_, {"/tf"})) give_up("a client is not served");
    const auto begin = std::chrono::steady_clock::now();
    while (!stop.stop_requested()) {
      const auto message = client_.hear(0.5);
      const std::int64_t now = now_ns();
      // The first second is that of joining.
      if (!message || !message->binary || std::chrono::steady_clock::now() - begin < 1s) continue;
      const auto whole = numbers_behind(message->payload(), "\"sec\":");
      const auto rest = numbers_behind(message->payload(), "\"nsec\":");
      std::int64_t oldest = now;
      for (std::size_t i = 0; i < whole.size(); ++i)
        oldest = std::min(oldest, whole[i] * 1'000'000'000 + rest[i]);
      seen_.ages.push_back(1e-6 * static_cast<double>(now - oldest));
      seen_.frames += whole.size();
    }
  }

  WebClient client_;
  Seen seen_;
  std::jthread thread_;
};

/// The bytes of a tick from one thread to another, at the same rate, by the kernel alone.
class Floor {
 public:
  Floor() {
    if (::socketpair(AF_UNIX, SOCK_STREAM, 0, ends_) != 0) give_up("no sockets");
    reader_ = std::jthread([this] { read(); });
    writer_ = std::jthread([this](const std::stop_token& stop) { write(stop); });
  }
  ~Floor() { stop(); }
  Floor(const Floor&) = delete;
  Floor& operator=(const Floor&) = delete;
  std::vector<double> stop() {
    if (!writer_.joinable()) return {};
    writer_.request_stop();
    writer_.join();
    ::shutdown(ends_[0], SHUT_WR);
    reader_.join();
    for (const int end : ends_) ::close(end);
    return std::move(ages_);
  }

 private:
  using Bytes = std::array<std::int64_t, 1500>;
  void write(const std::stop_token& stop) {
    auto next = std::chrono::steady_clock::now();
    while (!stop.stop_requested()) {
      next += std::chrono::nanoseconds(static_cast<long>(1e9 / rate));
      std::this_thread::sleep_until(next);
      Bytes bytes{now_ns()};
      if (::write(ends_[0], bytes.data(), sizeof bytes) != sizeof bytes) return;
    }
  }
  void read() {
    Bytes bytes{};
    while (::recv(ends_[1], bytes.data(), sizeof bytes, MSG_WAITALL) == sizeof bytes)
      ages_.push_back(1e-6 * static_cast<double>(now_ns() - bytes[0]));
  }

  int ends_[2]{};
  std::vector<double> ages_;
  std::jthread reader_, writer_;
};

/// clients watch for that long; stuck: one beside them takes nothing.
ordered_json watch(const Console& console, Mover& mover, int clients, bool stuck, double seconds) {
  std::optional<WebClient> sleeper;
  if (stuck) {
    sleeper.emplace(console.port(), "foxglove.sdk.v1");
    subscribe(*sleeper, {"/tf", "/camera/image", "camera/image"});
    mover.pictures = true;
  }
  std::vector<std::unique_ptr<Watcher>> watchers;
  for (int i = 0; i < clients; ++i) watchers.push_back(std::make_unique<Watcher>(console.port()));
  std::this_thread::sleep_for(1s);
  Floor floor;
  const double used = console.used();
  const auto begin = std::chrono::steady_clock::now();
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
  const double share =
      (console.used() - used) /
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const std::vector<double> least = floor.stop();
  std::vector<double> ages;
  std::size_t fewest = SIZE_MAX;
  for (auto& watcher : watchers) {
    const auto own = watcher->stop();
    fewest = std::min(fewest, own.frames);
    ages.insert(ages.end(), own.ages.begin(), own.ages.end());
  }
  mover.pictures = false;
  return {{"clients", clients},
          {"stuck", stuck},
          {"core_percent", 100 * share},
          {"p50_ms", quantile(ages, 0.5)},
          {"p99_ms", quantile(ages, 0.99)},
          {"floor_p50_ms", quantile(least, 0.5)},
          {"floor_p99_ms", quantile(least, 0.99)},
          {"least_frames_per_second", clients ? static_cast<double>(fewest) / seconds : 0},
          {"memory_mb", console.memory_mb()}};
}

/// Fifty at a time come, look at a few messages and go.
ordered_json come_and_go(const Console& console, double seconds) {
  ordered_json memory = ordered_json::array();
  const auto begin = std::chrono::steady_clock::now();
  int visits = 0;
  double next = 0;
  while (true) {
    const double passed =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (passed >= next) {
      memory.push_back(console.memory_mb());
      next += seconds / 5;
    }
    if (passed > seconds) break;
    std::vector<std::unique_ptr<WebClient>> all;
    for (int i = 0; i < 50; ++i)
      all.push_back(std::make_unique<WebClient>(console.port(), "foxglove.sdk.v1"));
    for (auto& client : all)
      if (subscribe(*client, {"/tf", "/scene", "/log"}) && client->hear(5)) ++visits;
  }
  return {{"seconds", seconds}, {"visits", visits}, {"memory_mb", memory}};
}

/// Median of the world's own p50 of «glove to accepted», with ten clients and without, in turns.
ordered_json in_a_lab(double seconds, int turns, const std::filesystem::path& folder) {
  const Place place;
  stage::Lab lab((share_directory() / "lab.toml").string(),
                 {"lab.rig=" + place.rig, fmt::format("lab.domain={}", place.domain),
                  "safety.state=" + (folder / "state").string()},
                 folder);
  const Console console(place, folder);
  auto joined = dds::Participant::create(
      {.name = "watcher", .domain = place.domain, .rig = place.rig, .network = {}});
  if (!joined) give_up(joined.error().message());
  auto statuses = *joined->reader(dds::service_status);
  for (const char* name : {"simulation", "mapping", "glove"})
    if (const auto started = lab.start_service(name); !started) give_up(started.error().message());
  std::vector<double> p50s[2], p99s[2];
  for (int turn = -1; turn < turns; ++turn) {
    const bool watched = turn % 2 == 0;
    std::vector<std::unique_ptr<Watcher>> watchers;
    for (int i = 0; watched && i < 10; ++i)
      watchers.push_back(std::make_unique<Watcher>(console.port()));
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    double p50 = 0, p99 = 0;
    while (std::chrono::steady_clock::now() < end) {
      statuses.raw().wait_for_unread_message({1, 0});
      for (const auto& sample : statuses.take())
        for (const auto& stage : sample.data.latency())
          if (!sample.info.gone && std::string_view(stage.stage().c_str()) == "glove to accepted") {
            p50 = stage.p50_us();
            p99 = stage.p99_us();
          }
    }
    for (auto& watcher : watchers) watcher->stop();
    if (const auto dead = lab.casualty()) give_up(dead->message());
    if (turn < 0) continue;  // it has come up meanwhile
    if (p50 == 0) give_up("the lab tells no latency");
    p50s[watched].push_back(p50);
    p99s[watched].push_back(p99);
  }
  return {{"watched_p50_us", p50s[1]},
          {"alone_p50_us", p50s[0]},
          {"ratio_of_medians", quantile(p50s[1], 0.5) / quantile(p50s[0], 0.5)},
          {"watched_p99_us", p99s[1]},
          {"alone_p99_us", p99s[0]}};
}

}  // namespace
}  // namespace prehend

int main(int argc, char** argv) {
  using namespace prehend;
  double seconds = 0, hold = 0, visits = 0;
  bool lab = false;
  int turns = 4;
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--lab") lab = true;
    if (argument == "--seconds" && i + 1 < argc) seconds = std::atof(argv[++i]);
    if (argument == "--turns" && i + 1 < argc) turns = std::atoi(argv[++i]);
    if (argument == "--visits" && i + 1 < argc) visits = std::atof(argv[++i]);
    if (argument == "--hold" && i + 1 < argc) hold = std::atof(argv[++i]);
  }
  if (seconds <= 0) seconds = lab ? 35 : 8;
  const auto folder = stage::TemporaryFolder::create(false);
  if (!folder) give_up(folder.error().message());
  if (lab) {
    std::cout << in_a_lab(seconds, std::max(turns, 2), folder->path()).dump() << "\n";
    return 0;
  }
  const Place place;
  Mover mover(place);
  const Console console(place, folder->path());
  if (hold > 0) {
    std::cout << console.address() << std::endl;
    std::this_thread::sleep_for(std::chrono::duration<double>(hold));
    return 0;
  }
  if (visits > 0) {
    std::cout << come_and_go(console, visits).dump() << "\n";
    return 0;
  }
  for (const auto& [clients, stuck] :
       {std::pair{0, false}, {1, false}, {10, false}, {10, true}, {50, false}})
    std::cout << watch(console, mover, clients, stuck, seconds).dump() << std::endl;
  std::cout << come_and_go(console, 5 * seconds).dump() << "\n";
  return 0;
}
