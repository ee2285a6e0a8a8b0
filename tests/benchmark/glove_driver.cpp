// The drivers of gloves at 100 Hz, the tracker with four sensors and both records that carry a
// whole pose well:
//  - a driver's processor time, alone in a process, as a share of one core (aim: below 1 %)
//  - from the last byte of a frame on the line until the service has published the posture, against
//    a floor in the same run: a process that reads as many bytes from a bare pseudo-terminal and
//    writes a posture to DDS (aim: at most twice that)
// All three hang on lines of this process, which is the glove, and are served in turn, so that a
// machine that changes its speed changes all of them. A sample's source time stamp tells when it
// was published.
//
//   benchmark_glove_driver [--json] [--seconds S]
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/base/clock.hpp"
#include "common/base/paths.hpp"
#include "common/dds/participant.hpp"
#include "common/serial/pseudo_terminal.hpp"
#include "common/stage/process.hpp"
#include "services/glove/devices/device.hpp"
#include "tests/support/domains/domain_lease.hpp"

namespace prehend {
namespace {

using namespace std::chrono_literals;

constexpr double rate = 100;

template <class T>
T must(Expected<T> made) {
  if (made) return std::move(*made);
  std::cerr << made.error().message() << "\n";
  std::exit(3);
}

dds::Participant join(int domain, const std::string& rig, const char* name) {
  return must(dds::Participant::create({.name = name, .domain = domain, .rig = rig}));
}

/// The floor: so many bytes read, a posture written.
int floor(const std::string& port, int domain, const std::string& rig, std::size_t bytes) {
  auto participant = join(domain, rig, "floor");
  auto writer = must(participant.writer(dds::hand_posture));
  v1::HandPosture posture;
  posture.glove("floor");
  const int line = ::open(port.c_str(), O_RDWR | O_NOCTTY);
  termios settings{};
  ::tcgetattr(line, &settings);
  ::cfmakeraw(&settings);
  ::tcsetattr(line, TCSANOW, &settings);
  std::array<char, 4096> buffer;
  std::size_t seen = 0;
  while (true) {
    const ssize_t count = ::read(line, buffer.data(), buffer.size());
    if (count <= 0) return 0;
    seen += static_cast<std::size_t>(count);
    if (seen < bytes) continue;
    seen -= bytes;
    posture.sequence_number(posture.sequence_number() + 1);
    posture.stamp_ns(to_ns(process_now()));
    writer.write(posture);
  }
}

glove::DeviceOptions device_options(const std::string& port, const std::string& format) {
  glove::DeviceOptions options;
  options.port = port;
  options.format = format;
  options.rate = rate;
  return options;
}

/// The driver, and nobody who listens.
int driver(const std::string& kind, const std::string& port, const std::string& format) {
  const auto device = must(must(glove::find_device(kind)).create(device_options(port, format)));
  device->start({.frame = [](const glove::Frame&) {},
                 .degraded = [](const std::string&) {},
                 .drop = [](std::string_view, std::uint64_t) {}});
  while (getppid() != 1) std::this_thread::sleep_for(1s);
  return 0;
}

/// s of processor time that a process has used.
double cpu_time(pid_t pid) {
  std::ifstream stream(fmt::format("/proc/{}/stat", pid));
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  std::istringstream fields(text.substr(text.rfind(')') + 2));
  std::string skipped;
  double user = 0, system = 0;
  for (int i = 0; i < 11; ++i) fields >> skipped;
  fields >> user >> system;
  return (user + system) / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

/// A line with a device at this end.
class DeviceLine {
 public:
  /// port: of this machine, for what sends datagrams.
  DeviceLine(const glove::DeviceKind& kind, const std::string& format, int port)
      : datagrams_(kind.line == glove::Line::datagrams) {
    const std::string address = datagrams_ ? fmt::format("127.0.0.1:{}", port) : "";
    const auto emulation = glove::emulation_of(kind, device_options(address, format), {});
    plug_ = must(emulation.plug_in());
    device_ = emulation.device();
  }

  std::string where() const { return plug_->where(); }
  void listen(Duration now) {
    const std::string answer = device_->receive(plug_->read(0ns), now);
    if (!answer.empty()) plug_->write(answer);
  }
  /// Sends all but the last byte. False: the device has nothing to say.
  bool begin(const glove::Frame& frame, Duration now) {
    rest_.clear();
    for (const std::string& record : device_->measure(frame, now)) rest_ += record;
    sent_ += rest_.size();
    if (rest_.empty() || datagrams_) return !rest_.empty();
    plug_->write(std::string_view(rest_).substr(0, rest_.size() - 1));
    rest_.erase(0, rest_.size() - 1);
    return true;
  }
  void finish() {
    if (!rest_.empty()) plug_->write(rest_);
  }
  std::size_t sent() const { return sent_; }

 private:
  bool datagrams_;
  std::unique_ptr<serial::Plug> plug_;
  std::unique_ptr<glove::Emulator> device_;
  std::string rest_;
  std::size_t sent_ = 0;
};

/// A hand that opens and closes and moves to and fro.
glove::Frame hand(int n) {
  const double wave = std::sin(0.02 * n);
  const double closure = 0.4 + 0.3 * wave;
  const auto posture = model::HumanHand::posture({closure, closure, closure, closure, closure});
  const Pose X_TH = make_pose({0.05 * wave, -0.4, 0.02});
  glove::Frame frame;
  frame.readings.push_back(
      {glove::Site::back_of_hand, true, X_TH.translation(), Eigen::Quaterniond::Identity()});
  const auto tips = model::HumanHand(1).fingertip_poses(posture);
  for (std::size_t f = 0; f < tips.size(); ++f)
    frame.readings.push_back({static_cast<glove::Site>(f + 1), true, X_TH * tips[f].translation(),
                              Eigen::Quaterniond::Identity()});
  frame.joint_angles.assign(posture.begin(), posture.end());
  return frame;
}

struct Stats {
  double driver_cpu = 0, service_cpu = 0;  // share of a core
  double floor_us = 0, service_us = 0;     // medians
  std::size_t samples = 0;
};

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

Stats measure(const std::string& kind, const std::string& format, double length,
              const std::string& self) {
  const test::DomainLease lease;
  const int domain = lease.domain();
  const std::string rig = fmt::format("glove-driver-{}", ::getpid());
  const auto row = must(glove::find_device(kind));
  DeviceLine driver_line(row, format, lease.port(0)), service_line(row, format, lease.port(1));
  auto floor_line = must(serial::PseudoTerminal::open({}));
  constexpr std::size_t bytes = 100;  // as four sensors' matrices have

  auto participant = join(domain, rig, "watcher");
  auto reader = must(participant.reader(dds::hand_posture));
  const auto log = std::filesystem::temp_directory_path() / rig;
  const auto spawn = [&](std::vector<std::string> command) {
    return must(stage::Process::start({.command = std::move(command), .log = log}));
  };
  auto driver_process = spawn({self, "--driver", kind, driver_line.where(), format});
  auto floor_process = spawn(
      {self, "--floor", floor_line.path(), std::to_string(domain), rig, std::to_string(bytes)});
  auto service_process =
      spawn({(program_directory() / "prehend-glove").string(), "--set", "lab.rig=" + rig, "--set",
             "lab.domain=" + std::to_string(domain), "--set", "glove.device=" + kind, "--set",
             "glove.port=" + service_line.where(), "--set", "glove.format=" + format, "--set",
             fmt::format("glove.rate={}", rate)});

  Stats stats;
  std::vector<double> floors, services;
  const auto start = std::chrono::steady_clock::now();
  const auto elapsed = [&] {
    return std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now() - start);
  };
  const double warm_up = 5;
  double driver_begin = 0, service_begin = 0, cpu_begin = 0;
  Time floor_sent{}, service_sent{};
  for (int n = 0; to_seconds(elapsed()) < warm_up + length; ++n) {
    if (cpu_begin == 0 && to_seconds(elapsed()) >= warm_up) {
      cpu_begin = to_seconds(elapsed());
      driver_begin = cpu_time(driver_process.pid());
      service_begin = cpu_time(service_process.pid());
    }
    const Duration due = seconds(n / rate);
    while (elapsed() < due) {
      driver_line.listen(elapsed());
      service_line.listen(elapsed());
      std::this_thread::sleep_for(
          std::min<Duration>(1ms, std::max<Duration>(0ns, due - elapsed())));
    }
    const glove::Frame frame = hand(n);
    if (driver_line.begin(frame, elapsed())) driver_line.finish();
    const bool any = service_line.begin(frame, elapsed());
    const std::string to_floor(bytes, 'x');
    floor_line.write(std::string_view(to_floor).substr(1));
    std::this_thread::sleep_for(2ms);
    floor_sent = process_now();
    floor_line.write("x");
    std::this_thread::sleep_for(2ms);
    service_sent = process_now();
    if (any) service_line.finish();
    std::this_thread::sleep_for(2ms);
    for (const auto& sample : reader.take()) {
      if (sample.info.gone || cpu_begin == 0) continue;
      const bool is_floor = std::string_view(sample.data.glove().c_str()) == "floor";
      const double us = 1e6 * to_seconds(sample.info.sent - (is_floor ? floor_sent : service_sent));
      if (us > 0) (is_floor ? floors : services).push_back(us);
    }
  }
  const double span = to_seconds(elapsed()) - cpu_begin;
  stats.driver_cpu = (cpu_time(driver_process.pid()) - driver_begin) / span;
  stats.service_cpu = (cpu_time(service_process.pid()) - service_begin) / span;
  stats.floor_us = median(floors);
  stats.service_us = median(services);
  stats.samples = services.size();
  if (services.empty() || driver_line.sent() == 0) {
    std::cerr << "no postures: " << stage::last_lines(log, 5) << "\n";
    std::exit(3);
  }
  for (auto* process : {&service_process, &floor_process, &driver_process}) process->stop(1s);
  std::filesystem::remove(log);
  return stats;
}

int run(bool json, double length, const std::string& self) {
  nlohmann::json rows = nlohmann::json::array();
  const std::pair<const char*, const char*> devices[] = {{"nest_of_birds", "position_quaternion"},
                                                         {"nest_of_birds", "position_matrix"},
                                                         {"joint_glove", "-"},
                                                         {"landmarks", "-"}};
  for (const auto& [kind, format] : devices) {
    const Stats f = measure(kind, *format == '-' ? "position_matrix" : format, length, self);
    rows.push_back({{"device", kind},
                    {"format", format},
                    {"driver_cpu_percent", 100 * f.driver_cpu},
                    {"service_cpu_percent", 100 * f.service_cpu},
                    {"floor_us", f.floor_us},
                    {"published_us", f.service_us},
                    {"ratio_of_medians", f.service_us / f.floor_us},
                    {"samples", f.samples}});
    if (!json)
      fmt::print(
          "{} {}: driver {:.2f} % of a core, the whole service {:.2f} %; last byte to published: "
          "floor "
          "{:.0f} us, service {:.0f} us, ratio of medians {:.2f} ({} frames)\n",
          kind, format, 100 * f.driver_cpu, 100 * f.service_cpu, f.floor_us, f.service_us,
          f.service_us / f.floor_us, f.samples);
  }
  if (json) std::cout << rows.dump() << "\n";
  return 0;
}

}  // namespace
}  // namespace prehend

int main(int argc, char** argv) {
  using namespace prehend;
  const std::string_view role = argc > 1 ? argv[1] : "";
  if (role == "--driver" && argc == 5) return driver(argv[2], argv[3], argv[4]);
  if (role == "--floor" && argc == 6)
    return floor(argv[2], std::atoi(argv[3]), argv[4], std::strtoul(argv[5], nullptr, 10));
  bool json = false;
  double length = 20;
  for (int i = 1; i < argc; ++i) {
    if (std::string_view(argv[i]) == "--json") json = true;
    if (std::string_view(argv[i]) == "--seconds" && i + 1 < argc) length = std::atof(argv[++i]);
  }
  return run(json, length, std::filesystem::read_symlink("/proc/self/exe").string());
}
