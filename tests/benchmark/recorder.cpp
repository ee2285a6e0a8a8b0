// The real recorder, pinned to a core of its own, against what it must keep up with and against the
// plain write of the same bytes to the same disk by the same core, in the same run. Postures of
// 500 B and pictures of 1 MB come from a real writer on the other core; none of them is the same
// as the one before, and pictures do not compress, as JPEG does not. Then the time of
// `prehend recording info`, a whole process, on a file of 1 GB.
//
//   benchmark_recorder [--json] [--seconds S] [--folder DIR]     files are written to DIR
#include <fcntl.h>
#include <fmt/format.h>
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <fstream>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/base/paths.hpp"
#include "common/base/random.hpp"
#include "common/dds/raw.hpp"
#include "common/recording/mcap/reader.hpp"
#include "common/recording/mcap/writer.hpp"
#include "common/stage/process.hpp"
#include "tests/support/domains/domain_lease.hpp"

namespace prehend {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr int our_core = 0, recorders_core = 1;

[[noreturn]] void give_up(const std::string& why) {
  std::cerr << why << "\n";
  std::exit(3);
}

template <class T>
T must(Expected<T> value) {
  if (!value) give_up(value.error().message());
  return std::move(*value);
}

/// This thread and all that it starts from now on.
void pin_to(int core) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(core, &set);
  if (::sched_setaffinity(0, sizeof set, &set) != 0) give_up("two cores are needed");
}

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Processor time, in s, of this process or of its children that have ended.
double processor_time(int who) {
  rusage usage{};
  ::getrusage(who, &usage);
  const auto in_s = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return in_s(usage.ru_utime) + in_s(usage.ru_stime);
}

/// The largest resident memory that a running process has had, in MB.
double peak_memory_mb(pid_t pid) {
  std::ifstream status(fmt::format("/proc/{}/status", pid));
  for (std::string word; status >> word;)
    if (word == "VmHWM:") {
      double kb = 0;
      status >> kb;
      return kb * 1024 * 1e-6;
    }
  return 0;
}

/// Noise of sensors on slow movements: 500 B on the wire.
std::vector<v1::HandPosture> postures() {
  Random random(1);
  std::vector<v1::HandPosture> all(4096);
  for (std::size_t i = 0; i < all.size(); ++i) {
    v1::HandPosture& posture = all[i];
    const auto value = [&](double scale) {
      return scale * std::sin(1e-3 * static_cast<double>(i)) + 1e-3 * random.normal();
    };
    posture.glove("glove");
    posture.user("somebody");
    posture.hand_scale(1);
    posture.quality(0.9);
    posture.X_WH().position().x(value(0.3));
    posture.X_WH().position().y(value(0.2));
    posture.X_WH().position().z(value(0.1));
    posture.X_WH().orientation().w(value(1));
    for (v1::Fingertip& tip : posture.fingertips()) {
      tip.valid(true);
      tip.p_HF().x(value(0.1));
      tip.p_HF().y(value(0.05));
      tip.p_HF().z(value(0.02));
    }
    for (int joint = 0; joint < 25; ++joint) posture.joint_angles().push_back(value(0.5));
  }
  return all;
}

std::vector<v1::CameraImage> pictures() {
  Random random(2);
  std::vector<v1::CameraImage> all(16);
  for (v1::CameraImage& picture : all) {
    picture.camera("camera");
    picture.width(1920);
    picture.height(1080);
    picture.encoding("jpeg");
    picture.data().resize(1'000'000);
    for (std::uint8_t& byte : picture.data()) byte = static_cast<std::uint8_t>(random.bits());
  }
  return all;
}

struct Run {
  double rate = 0, seconds = 0;  // messages/s that were sent, for so long
  std::uint64_t sent = 0, bytes = 0, recorded = 0, said_lost = 0;
  double load = 0;  // of the recorder's core
  double processor_s = 0, peak_mb = 0;
  bool lossless() const { return recorded == sent && said_lost == 0; }
  double mb_per_s() const { return static_cast<double>(bytes) * 1e-6 / seconds; }
};

struct Plain {
  double mb_per_s = 0, processor_s_per_mb = 0;
};

class Bench {
 public:
  explicit Bench(std::filesystem::path folder)
      : folder_(std::move(folder)), rig_(fmt::format("benchmark-{}", ::getpid())) {
    pin_to(our_core);
    std::filesystem::create_directories(folder_);
  }
  ~Bench() { std::filesystem::remove_all(folder_); }

  /// Sends at a rate for a time while the recorder records.
  template <class P>
  Run record(const dds::Topic<P>& topic, std::vector<typename P::type>& messages, double rate,
             double seconds, const std::vector<std::string>& more = {}) {
    const double processor_before = processor_time(RUSAGE_CHILDREN);
    auto recorder = start_recorder(topic.name, more);
    auto participant =
        must(dds::Participant::create({.name = "benchmark", .domain = domain_, .rig = rig_}));
    auto writer = must(participant.writer(topic));
    eprosima::fastdds::dds::PublicationMatchedStatus matched;
    while (matched.current_count == 0 && !recorder.exit())
      writer.raw().get_publication_matched_status(matched);

    Run run = send(writer, messages, rate, seconds);
    run.bytes = run.sent * dds::encode(topic, messages.front()).size();
    // Reliable topics: until it has all. What is still on its way on others comes at once.
    writer.raw().wait_for_acknowledgments({5, 0});
    std::this_thread::sleep_for(200ms);
    run.peak_mb = peak_memory_mb(recorder.pid());
    recorder.signal(SIGTERM);
    const auto exit = recorder.wait(20s);
    if (!exit || exit->code != 0) give_up(stage::last_lines(folder_ / "log", 5));
    run.processor_s = processor_time(RUSAGE_CHILDREN) - processor_before;
    run.load = run.processor_s / run.seconds;
    count_what_was_recorded(run);
    return run;
  }

  /// The same bytes by the same core to the same disk, in blocks of 1 MiB.
  template <class P>
  Plain write_plainly(const dds::Topic<P>& topic, const std::vector<typename P::type>& messages,
                      std::uint64_t bytes) {
    std::vector<std::vector<std::uint8_t>> encoded;
    for (const auto& message : messages) encoded.push_back(dds::encode(topic, message));
    pin_to(recorders_core);
    const double processor_before = processor_time(RUSAGE_SELF);
    const auto start = Clock::now();
    auto file = must(recording::mcap::File::create(folder_ / "plain"));
    recording::mcap::Bytes block;
    for (std::size_t i = 0; file.size() + block.size() < bytes; ++i) {
      recording::mcap::append(block, recording::mcap::View(encoded[i % encoded.size()]));
      if (block.size() < 1 << 20) continue;
      if (!file.write(block)) give_up("the disk is full");
      block.clear();
    }
    if (!file.write(block)) give_up("the disk is full");
    const double mb = static_cast<double>(file.size()) * 1e-6;
    const Plain plain{mb / seconds_since(start),
                      (processor_time(RUSAGE_SELF) - processor_before) / mb};
    std::filesystem::remove(folder_ / "plain");
    pin_to(our_core);
    return plain;
  }

  /// The highest rate without loss, by steps of a quarter, from `rate` on.
  template <class P>
  Run highest(const dds::Topic<P>& topic, std::vector<typename P::type>& messages, double rate) {
    Run best;
    while (true) {
      const Run run = record(topic, messages, rate, 3);
      // Beyond what this process can send a higher rate says nothing.
      if (!run.lossless() || run.rate < 0.97 * rate) return best.sent > 0 ? best : run;
      best = run;
      rate *= 1.25;
    }
  }

  struct Info {
    double size_mb = 0, warm_ms = 0, cold_ms = 0, floor_ms = 0;
  };
  Info time_info() {
    const std::filesystem::path file = folder_ / "large.mcap";
    auto messages = postures();
    auto writer =
        std::make_unique<recording::mcap::Writer>(must(recording::mcap::Writer::create(file)));
    // As a rig has them: a dozen topics with some instances each.
    std::vector<std::uint16_t> channels;
    for (int i = 0; i < 40; ++i)
      channels.push_back(must(writer->add_channel(0, fmt::format("topic/{}", i % 14), "cdr")));
    for (std::uint32_t i = 0; writer->size() < 1'000'000'000; ++i) {
      const auto payload = dds::encode(dds::hand_posture, messages[i % messages.size()]);
      if (!writer->write(recording::mcap::Message{channels[i % 40], i, i * 50'000ull, i, payload}))
        give_up("the disk is full");
    }
    if (!writer->close()) give_up("the disk is full");
    Info info;
    info.size_mb = static_cast<double>(std::filesystem::file_size(file)) * 1e-6;
    const std::string program = (program_directory() / "prehend").string();
    info.floor_ms = median_ms({program, "recording", "info", "--help"}, [] {});
    const std::vector<std::string> command{program, "recording", "info", file.string()};
    info.warm_ms = median_ms(command, [] {});
    info.cold_ms = median_ms(command, [&] {
      const int descriptor = ::open(file.c_str(), O_RDONLY);
      ::fsync(descriptor);
      ::posix_fadvise(descriptor, 0, 0, POSIX_FADV_DONTNEED);
      ::close(descriptor);
    });
    std::filesystem::remove(file);
    return info;
  }

 private:
  /// On its own core.
  stage::Process start_recorder(std::string_view topic, const std::vector<std::string>& more) {
    std::vector<std::string> command{(program_directory() / "prehend-record").string(),
                                     "--output",
                                     (folder_ / "run.mcap").string(),
                                     "--force",
                                     "--json",
                                     "--set",
                                     "lab.rig=" + rig_,
                                     "--set",
                                     fmt::format("lab.domain={}", domain_),
                                     std::string(topic)};
    command.insert(command.end(), more.begin(), more.end());
    std::filesystem::remove(folder_ / "answer");
    pin_to(recorders_core);
    auto recorder = must(stage::Process::start(
        {.command = command, .log = folder_ / "log", .output = folder_ / "answer"}));
    pin_to(our_core);
    return recorder;
  }

  /// Message after message, each numbered and stamped as it is sent.
  template <class Writer, class Message>
  static Run send(Writer& writer, std::vector<Message>& messages, double rate, double seconds) {
    Run run;
    const auto start = Clock::now();
    const auto wanted = static_cast<std::uint64_t>(rate * seconds);
    while (run.sent < wanted) {
      const auto due = static_cast<std::uint64_t>(rate * seconds_since(start)) + 1;
      for (; run.sent < std::min(due, wanted); ++run.sent) {
        Message& message = messages[run.sent % messages.size()];
        message.sequence_number(run.sent);
        message.stamp_ns(to_ns(std::chrono::system_clock::now()));
        writer.write(message);
      }
      std::this_thread::sleep_for(500us);
    }
    run.seconds = seconds_since(start);
    run.rate = static_cast<double>(run.sent) / run.seconds;
    return run;
  }

  /// By what the recorder said at its end, and by its files, which go.
  void count_what_was_recorded(Run& run) const {
    const auto answer = nlohmann::json::parse(std::ifstream(folder_ / "answer"));
    run.said_lost = answer["lost"];
    // What is only in a ring is in no file that could be counted.
    if (answer["files"].empty()) run.recorded = run.sent - run.said_lost;
    for (const std::string path : answer["files"])
      run.recorded += must(recording::mcap::Reader::open(path)).statistics().message_count;
    for (const std::string path : answer["files"]) std::filesystem::remove(path);
  }

  template <class Prepare>
  double median_ms(const std::vector<std::string>& command, Prepare prepare) {
    std::vector<double> times;
    for (int i = 0; i < 21; ++i) {
      prepare();
      const auto start = Clock::now();
      auto process = must(stage::Process::start({.command = command, .log = folder_ / "log"}));
      const auto exit = process.wait(20s);
      times.push_back(1e3 * seconds_since(start));
      if (!exit || exit->code != 0) give_up(stage::last_lines(folder_ / "log", 5));
    }
    std::ranges::sort(times);
    return times[times.size() / 2];
  }

  std::filesystem::path folder_;
  const test::DomainLease lease_;
  const int domain_ = lease_.domain();
  std::string rig_;
};

struct Report {
  bool json;
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();

  void head() const {
    if (json) return;
    fmt::print(
        "| what | sent | MB/s | lost | load of the core | peak memory | MB/s of the plain "
        "write | processor time against it |\n|---|---|---|---|---|---|---|---|\n");
  }
  void add(const std::string& what, const Run& run, const Plain& plain) {
    const double ratio =
        run.processor_s / (static_cast<double>(run.bytes) * 1e-6) / plain.processor_s_per_mb;
    rows.push_back({{"what", what},
                    {"rate_hz", run.rate},
                    {"seconds", run.seconds},
                    {"sent", run.sent},
                    {"recorded", run.recorded},
                    {"lost", run.sent - run.recorded},
                    {"said_lost", run.said_lost},
                    {"mb_per_s", run.mb_per_s()},
                    {"load", run.load},
                    {"peak_mb", run.peak_mb},
                    {"plain_mb_per_s", plain.mb_per_s},
                    {"speed_ratio", run.mb_per_s() / plain.mb_per_s},
                    {"processor_ratio", ratio}});
    if (!json)
      fmt::print(
          "| {} | {:.0f}/s for {:.0f} s | {:.1f} | {} | {:.0f} % | {:.0f} MB | {:.0f} | {:.1f} |\n",
          what, run.rate, run.seconds, run.mb_per_s(), run.sent - run.recorded, 100 * run.load,
          run.peak_mb, plain.mb_per_s, ratio);
    std::fflush(stdout);
  }
};

int run(bool json, double seconds, const std::filesystem::path& folder) {
  Bench bench(folder / fmt::format("prehend-benchmark-{}", ::getpid()));
  auto small = postures();
  auto large = pictures();
  Report report{json};
  report.head();
  const auto small_plain = [&](const Run& one) {
    return bench.write_plainly(dds::hand_posture, small, one.bytes);
  };
  const auto large_plain = [&](const Run& one) {
    return bench.write_plainly(dds::camera_image, large, one.bytes);
  };
  for (const double length : {seconds, 6 * seconds}) {
    const Run postures_run = bench.record(dds::hand_posture, small, 20'000, length);
    report.add("500 B", postures_run, small_plain(postures_run));
    const Run pictures_run = bench.record(dds::camera_image, large, 100, length);
    report.add("1 MB", pictures_run, large_plain(pictures_run));
  }
  const Run ring = bench.record(dds::camera_image, large, 100, seconds,
                                {"--snapshot", "1000", "--snapshot-size", "100"});
  report.add("1 MB into a ring of 100 MB", ring, large_plain(ring));
  const Run rate_small = bench.highest(dds::hand_posture, small, 25'000);
  report.add("500 B, highest rate without loss", rate_small, small_plain(rate_small));
  const Run rate_large = bench.highest(dds::camera_image, large, 125);
  report.add("1 MB, highest rate without loss", rate_large, large_plain(rate_large));

  const auto info = bench.time_info();
  if (json)
    std::cout << nlohmann::ordered_json{{"recording", report.rows},
                                        {"info",
                                         {{"size_mb", info.size_mb},
                                          {"warm_ms", info.warm_ms},
                                          {"cold_ms", info.cold_ms},
                                          {"help_ms", info.floor_ms}}}}
                     .dump()
              << "\n";
  else
    fmt::print(
        "\n`prehend recording info` of {:.0f} MB: {:.1f} ms, from a cold disk {:.1f} ms; its "
        "--help: {:.1f} ms\n",
        info.size_mb, info.warm_ms, info.cold_ms, info.floor_ms);
  return 0;
}

}  // namespace
}  // namespace prehend

int main(int argc, char** argv) {
  bool json = false;
  double seconds = 5;
  std::filesystem::path folder = std::filesystem::current_path();
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--json") json = true;
    if (argument == "--seconds" && i + 1 < argc) seconds = std::atof(argv[++i]);
    if (argument == "--folder" && i + 1 < argc) folder = argv[++i];
  }
  return prehend::run(json, seconds, folder);
}
