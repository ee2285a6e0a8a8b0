#include "nest_of_birds.hpp"

#include <condition_variable>
#include <mutex>
#include <thread>

#include "bird_protocol.hpp"
#include "paced.hpp"
#include "serial_port.hpp"

namespace prehend::glove {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr Duration retry_after = milliseconds(200);
constexpr Duration settle = milliseconds(600);  // around auto-configure: 300 needed, 600 advised
constexpr Duration answer_time = milliseconds(200);
constexpr Duration quiet = milliseconds(30);  // longer than the gap between two records
constexpr Duration longest_silence = milliseconds(500);
constexpr char xon = 0x11;

/// Gathers the records of one cycle into a frame.
class Assembly {
 public:
  explicit Assembly(int sensors) : readings_(static_cast<std::size_t>(sensors)) { clear(); }

  /// Calls emit(frame) when a frame is complete, or the next one begins before it is.
  template <class Emit>
  void add(const bird::Record& record, Time now, const DeviceSink& sink, Emit emit) {
    const int address = record.address.value_or(1);
    if (address < 1 || address > static_cast<int>(readings_.size())) {
      sink.drop("unknown address", 1);
      return;
    }
    if (address <= last_) {
      sink.drop("incomplete frame", 1);
      finish(emit);
    }
    if (last_ == 0) stamp_ = now;
    last_ = address;
    Reading& reading = readings_[static_cast<std::size_t>(address - 1)];
    reading.p_TS = *record.position;
    if (record.quaternion) {
      reading.valid = true;  // its norm is judged with everything else
      reading.q_TS = *record.quaternion;
    } else if (const auto R = record.rotation()) {
      reading.valid = true;
      reading.q_TS = Eigen::Quaterniond(*R);
    } else {
      sink.drop("not a rotation", 1);
    }
    if (address == static_cast<int>(readings_.size())) finish(emit);
  }

 private:
  template <class Emit>
  void finish(Emit emit) {
    Frame frame;
    frame.sequence = sequence_++;
    frame.stamp = stamp_;
    frame.readings = readings_;
    emit(std::move(frame));
    clear();
  }
  void clear() {
    last_ = 0;
    for (std::size_t i = 0; i < readings_.size(); ++i)
      readings_[i] = Reading{.site = sites_by_address()[i], .valid = false};
  }

  std::vector<Reading> readings_;
  std::uint64_t sequence_ = 0;
  Time stamp_{};
  int last_ = 0;  // address of the last record; 0: none yet
};

class NestOfBirds final : public Device {
 public:
  NestOfBirds(std::string port, int baud, int sensors, bird::Format format)
      : path_(std::move(port)),
        baud_(baud),
        sensors_(sensors),
        format_(format),
        assembly_(sensors) {}

  void start(DeviceSink sink) override {
    sink_ = std::move(sink);
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }

 private:
  void run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      auto port = SerialPort::open(path_, baud_);
      auto done = port ? begin(*port, stop) : tl::unexpected(port.error());
      if (done && !stop.stop_requested()) done = stream(*port, stop);
      if (!done) {
        say(done.error().message());
        pause(stop, retry_after);
      }
    }
  }

  /// A line for the operator, once as long as nothing changes.
  void say(const std::string& line) {
    if (line == said_) return;
    said_ = line;
    sink_.degraded(line);
  }

  static void pause(const std::stop_token& stop, Duration duration) {
    std::mutex mutex;
    std::condition_variable_any wake;
    std::unique_lock lock(mutex);
    wake.wait_for(lock, stop, duration, [] { return false; });
  }

  Expected<void> begin(SerialPort& port, const std::stop_token& stop) {
    using std::string_literals::operator""s;
    port.discard_input();
    auto sent = port.write({&xon, 1});
    if (sent) sent = port.write("B");  // ends a stream
    if (!sent) return sent;
    if (auto drained = drain(port); !drained) return drained;

    const auto before = running(port);
    if (!before) return tl::unexpected(before.error());
    if (!*before) {
      if (sent = port.write("/"); !sent) return sent;
      pause(stop, settle);
      const char configure[] = {'P', bird::auto_configure, static_cast<char>(sensors_)};
      if (sent = port.write({configure, sizeof configure}); !sent) return sent;
      pause(stop, settle);
      if (stop.stop_requested()) return {};
      const auto after = running(port);
      if (!after) return tl::unexpected(after.error());
      if (!*after)
        return fail("the tracker does not answer, or not all of its sensors are there", path_,
                    "check its power, its baud rate and glove.sensors");
    }
    std::string setup = "P\x03\x01\x00"s + "P\x23\x01";
    for (int unit = 1; unit <= sensors_; ++unit) {
      setup.push_back(static_cast<char>(0xF0 + unit));
      setup.push_back(bird::info(format_).command);
    }
    return port.write(setup + "Q@");
  }

  /// Reads until nothing comes any more.
  Expected<void> drain(SerialPort& port) {
    const auto until = Clock::now() + milliseconds(300);
    while (Clock::now() < until) {
      auto bytes = port.read(quiet);
      if (!bytes) return tl::unexpected(bytes.error());
      if (bytes->empty()) break;
    }
    return {};
  }

  /// Do all units run? No also when nobody answers.
  Expected<bool> running(SerialPort& port) {
    const char examine[] = {'O', bird::system_status};
    if (auto sent = port.write({examine, sizeof examine}); !sent)
      return tl::unexpected(sent.error());
    std::string answer;
    const auto until = Clock::now() + answer_time;
    while (answer.size() < bird::most_units && Clock::now() < until) {
      auto bytes = port.read(milliseconds(20));
      if (!bytes) return tl::unexpected(bytes.error());
      answer += *bytes;
    }
    if (answer.size() != bird::most_units) return false;
    constexpr auto wanted = static_cast<std::uint8_t>(bird::running | bird::has_receiver);
    for (int unit = 0; unit < sensors_; ++unit)
      if ((static_cast<std::uint8_t>(answer[static_cast<std::size_t>(unit)]) & wanted) != wanted)
        return false;
    return true;
  }

  Expected<void> stream(SerialPort& port, const std::stop_token& stop) {
    bird::RecordParser parser(
        {.format = format_, .button = false, .group = true, .range = bird::long_range});
    std::uint64_t garbage = 0;
    auto last = Clock::now();
    while (!stop.stop_requested()) {
      auto bytes = port.read(milliseconds(50));
      if (!bytes) return tl::unexpected(bytes.error());
      const Time now = system_now();
      for (const bird::Record& record : parser.feed(*bytes)) {
        last = Clock::now();
        assembly_.add(record, now, sink_, [this](Frame frame) {
          said_.clear();
          sink_.frame(std::move(frame));
        });
      }
      if (parser.garbage() > garbage) sink_.drop("garbage bytes", parser.garbage() - garbage);
      garbage = parser.garbage();
      if (Clock::now() - last > longest_silence)
        return fail("the tracker has fallen silent", path_, "starts it again by itself");
    }
    return {};
  }

  std::string path_;
  int baud_, sensors_;
  bird::Format format_;
  DeviceSink sink_;
  std::string said_;
  Assembly assembly_;
  std::jthread thread_;  // last: joined before the rest goes
};

}  // namespace

Expected<std::unique_ptr<Device>> create_nest_of_birds(const DeviceOptions& options) {
  const auto format = bird::format_of_name(options.format);
  if (!format || *format < bird::Format::position_angles)
    return fail("'" + options.format + "' is no record with position and orientation",
                "glove.format", "choose position_angles, position_matrix or position_quaternion");
  if (options.port.empty())
    return fail("no port is named", "glove.port", "name one such as /dev/ttyUSB0");
  if (options.baud < 2400 || options.baud > 115200)
    return fail("the tracker knows 2400 to 115200 bits per second", "glove.baud");
  if (options.sensors < 1 || options.sensors > static_cast<int>(sites_by_address().size()))
    return fail("1 to 6 sensors are possible", "glove.sensors");
  return std::make_unique<NestOfBirds>(options.port, options.baud, options.sensors, *format);
}

}  // namespace prehend::glove
