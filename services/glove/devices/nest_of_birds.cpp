#include "services/glove/devices/nest_of_birds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "common/base/clock.hpp"
#include "common/base/log.hpp"
#include "common/serial/serial_port.hpp"
#include "services/glove/devices/bird_emulator.hpp"
#include "services/glove/devices/bird_protocol.hpp"
#include "services/glove/devices/bird_words.hpp"
#include "services/glove/devices/frame_clock.hpp"
#include "services/glove/devices/persistent.hpp"

namespace prehend::glove {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr Duration settle = milliseconds(600);  // around auto-configure: 300 needed, 600 advised
constexpr Duration bird_answer_time = milliseconds(200);
constexpr Duration bird_quiet = milliseconds(30);  // longer than the gap between two records
constexpr Duration max_bird_silence = milliseconds(500);
constexpr char xon = 0x11;

/// Gathers the records of one cycle into a frame.
class Assembly {
 public:
  explicit Assembly(std::vector<Site> sites) : sites_(std::move(sites)) { clear(); }

  /// Calls emit(frame) when a frame is complete, or the next one begins before it is. The stamp is
  /// when its first record came.
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
    if (const auto R = record.rotation()) {
      reading.valid = true;
      reading.q_TS = Eigen::Quaterniond(*R);
    } else {
      sink.drop("not a rotation", 1);
    }
    if (record.button) take_button(*record.button, sink);
    if (address == static_cast<int>(readings_.size())) finish(emit);
  }

 private:
  /// Each unit tells of the mouse at its own plug. What is no code of a button holds none.
  void take_button(int code, const DeviceSink& sink) {
    if (!held_) held_.emplace();
    const auto held = bird::held_buttons(code);
    if (!held) return sink.drop("unknown button", 1);
    for (const std::uint8_t button : *held)
      if (std::find(held_->begin(), held_->end(), button) == held_->end()) held_->push_back(button);
  }
  template <class Emit>
  void finish(Emit emit) {
    Frame frame;
    frame.sequence = sequence_++;
    frame.stamp = stamp_;
    frame.readings = std::move(readings_);
    frame.held = std::exchange(held_, std::nullopt);
    clear();
    emit(std::move(frame));
  }
  void clear() {
    last_ = 0;
    readings_.clear();
    for (const Site site : sites_) readings_.push_back({.site = site, .valid = false});
  }

  std::vector<Site> sites_;
  std::vector<Reading> readings_;
  std::optional<std::vector<std::uint8_t>> held_;
  std::uint64_t sequence_ = 0;
  Time stamp_{};
  int last_ = 0;  // address of the last record; 0: none yet
};

/// What the tracker shall do.
struct Setup {
  int sensors = 4;
  bird::Format format = bird::Format::position_matrix;
  double range = bird::long_range;  // m
  bird::HemisphereInfo hemisphere = bird::hemispheres[0];
  bool point = false;  // asked for each frame
  bool buttons = false;
  double rate = 30;  // Hz, at which it is asked

  /// A unit that stands alone has no bus, and its records no address.
  bool group() const { return sensors > 1; }
  bird::Layout layout() const {
    return {.format = format, .button = buttons, .group = group(), .range = range};
  }
  /// Everything is said to every unit, as each has settings of its own, perhaps from another day.
  std::string commands() const {
    using std::string_literals::operator""s;
    std::string text;
    for (int unit = 1; unit <= sensors; ++unit) {
      const std::string to = group() ? std::string(1, static_cast<char>(0xF0 + unit)) : "";
      text += to + "P\x03"s + (range > bird::short_range ? '\x01' : '\x00') + '\x00';
      text +=
          to + "L" + static_cast<char>(hemisphere.code[0]) + static_cast<char>(hemisphere.code[1]);
      text += to + (buttons ? "M\x01"s : "M\x00"s);
      text += to + bird::info(format).command;
    }
    return text + (group() ? "P\x23\x01"s : "P\x23\x00"s) + "Q";
  }
};

class NestOfBirds final : public Device {
 public:
  NestOfBirds(std::string port, int baud, std::vector<Site> sites, const Setup& setup)
      : path_(std::move(port)), baud_(baud), setup_(setup), assembly_(std::move(sites)) {}

  void start(DeviceSink sink) override {
    sink_ = std::move(sink);
    thread_.start([this](const std::stop_token& stop) { return live(stop); }, sink_.degraded);
  }

 private:
  Expected<void> live(const std::stop_token& stop) {
    auto port = serial::SerialPort::open(path_, baud_);
    if (!port) return tl::unexpected(port.error());
    if (auto begun = begin(*port, stop); !begun || stop.stop_requested()) return begun;
    clock_.restart();
    return setup_.point ? ask(*port, stop) : listen(*port, stop);
  }

  Expected<void> begin(serial::SerialPort& port, const std::stop_token& stop) {
    port.discard_input();
    auto sent = port.write({&xon, 1});
    if (sent) sent = port.write("B");  // ends a stream
    if (!sent) return sent;
    if (auto drained = drain(port); !drained) return drained;
    if (setup_.group()) {
      const auto before = running(port);
      if (!before) return tl::unexpected(before.error());
      if (!*before) {
        if (sent = configure(port, stop); !sent || stop.stop_requested()) return sent;
      }
    }
    if (auto answered = introduce(port); !answered) return answered;
    return port.write(setup_.commands());
  }

  Expected<void> configure(serial::SerialPort& port, const std::stop_token& stop) {
    if (auto sent = port.write("/"); !sent) return sent;
    Persistent::pause(stop, settle);
    const char command[] = {'P', bird::auto_configure, static_cast<char>(setup_.sensors)};
    if (auto sent = port.write({command, sizeof command}); !sent) return sent;
    Persistent::pause(stop, settle);
    if (stop.stop_requested()) return {};
    const auto after = running(port);
    if (!after) return tl::unexpected(after.error());
    if (*after) return {};
    const Error error{"the tracker does not answer, or not all of its sensors are there", path_,
                      "check its power, its baud rate and glove.sites"};
    // Bytes may be its own, which say that a sensor is missing.
    const bool sound = port.overheard().speaker() == serial::Speaker::bytes;
    return tl::unexpected(sound ? error : port.overheard().unanswered(error));
  }

  /// Asks it who it is, and says so when that is new.
  Expected<void> introduce(serial::SerialPort& port) {
    std::array<std::string, 4> answers;
    constexpr std::array asked{bird::model_name, bird::revision, bird::status, bird::error_code};
    for (std::size_t i = 0; i < asked.size(); ++i) {
      auto answer = examine(port, asked[i]);
      if (!answer) return tl::unexpected(answer.error());
      if (answer->size() != bird::examined_length(asked[i]))
        return tl::unexpected(silent(port, i > 0));
      answers[i] = *answer;
    }
    const auto byte = [](char c) { return static_cast<std::uint8_t>(c); };
    const auto word = static_cast<std::uint16_t>(byte(answers[2][0]) | byte(answers[2][1]) << 8);
    std::string name = answers[0].substr(0, answers[0].find_last_not_of(' ') + 1);
    for (char& c : name)
      if (c < ' ' || c > '~') c = '?';
    const std::string line =
        fmt::format("{}: {}, revision {}: {}", path_, name, bird::revision_in_words(answers[1]),
                    bird::status_in_words(word));
    if (line != introduced_) log::info("{}", line);
    introduced_ = line;
    // Reading it has cleared it. What it did not understand is what the line was full of before.
    if (const auto error = byte(answers[3][0]); error != 0 && error != 6)
      log::warning("{}: the tracker says: {}", path_, bird::error_in_words(error));
    return {};
  }

  /// knows: it has answered before, so what was heard was its own.
  Error silent(const serial::SerialPort& port, bool knows) const {
    Error error{"the tracker does not answer", path_, "check its power and its baud rate"};
    return knows ? error : port.overheard().unanswered(std::move(error));
  }

  /// Reads until nothing comes any more.
  Expected<void> drain(serial::SerialPort& port) {
    const auto until = Clock::now() + milliseconds(300);
    while (Clock::now() < until) {
      auto bytes = port.read(bird_quiet);
      if (!bytes) return tl::unexpected(bytes.error());
      if (bytes->empty()) break;
    }
    return {};
  }

  /// The answer, shorter if not all of it came in time.
  Expected<std::string> examine(serial::SerialPort& port, std::uint8_t parameter) {
    const char question[] = {'O', static_cast<char>(parameter)};
    if (auto sent = port.write({question, sizeof question}); !sent)
      return tl::unexpected(sent.error());
    std::string answer;
    const auto until = Clock::now() + bird_answer_time;
    while (answer.size() < bird::examined_length(parameter) && Clock::now() < until) {
      auto bytes = port.read(milliseconds(20));
      if (!bytes) return tl::unexpected(bytes.error());
      answer += *bytes;
    }
    return answer;
  }

  /// Do all units run? No also when nobody answers.
  Expected<bool> running(serial::SerialPort& port) {
    const auto answer = examine(port, bird::system_status);
    if (!answer) return tl::unexpected(answer.error());
    if (answer->size() != bird::max_units) return false;
    constexpr auto wanted = static_cast<std::uint8_t>(bird::running | bird::has_receiver);
    for (int unit = 0; unit < setup_.sensors; ++unit)
      if ((static_cast<std::uint8_t>((*answer)[static_cast<std::size_t>(unit)]) & wanted) != wanted)
        return false;
    return true;
  }

  /// Reads what comes and passes on what is complete; fails when nothing has come for too long.
  class Reader {
   public:
    Reader(NestOfBirds& device, serial::SerialPort& port)
        : device_(device), port_(port), parser_(device.setup_.layout()) {}

    /// Number of frames.
    Expected<int> read(Duration timeout) {
      auto bytes = port_.read(timeout);
      if (!bytes) return tl::unexpected(bytes.error());
      const Time now = process_now();
      int frames = 0;
      for (const bird::Record& record : parser_.feed(*bytes)) {
        last_ = Clock::now();
        device_.assembly_.add(record, now, device_.sink_, [&](Frame frame) {
          ++frames;
          device_.deliver(std::move(frame));
        });
      }
      if (parser_.garbage() > garbage_)
        device_.sink_.drop("garbage bytes", parser_.garbage() - garbage_);
      garbage_ = parser_.garbage();
      if (Clock::now() - last_ > max_bird_silence)
        return fail("the tracker has fallen silent", device_.path_, "starts it again by itself");
      return frames;
    }

   private:
    NestOfBirds& device_;
    serial::SerialPort& port_;
    bird::RecordParser parser_;
    std::uint64_t garbage_ = 0;
    Clock::time_point last_ = Clock::now();
  };

  Expected<void> listen(serial::SerialPort& port, const std::stop_token& stop) {
    if (auto sent = port.write("@"); !sent) return sent;
    Reader reader(*this, port);
    while (!stop.stop_requested())
      if (auto frames = reader.read(milliseconds(50)); !frames)
        return tl::unexpected(frames.error());
    return {};
  }

  Expected<void> ask(serial::SerialPort& port, const std::stop_token& stop) {
    Reader reader(*this, port);
    auto due = Clock::now();
    while (!stop.stop_requested()) {
      if (auto sent = port.write("B"); !sent) return sent;
      const auto lost =
          Clock::now() + bird_answer_time;  // asked again if no frame has come by then
      for (int frames = 0; frames == 0 && Clock::now() < lost && !stop.stop_requested();) {
        auto got = reader.read(milliseconds(20));
        if (!got) return tl::unexpected(got.error());
        frames = *got;
      }
      due = std::max(due + seconds(1 / setup_.rate), Clock::now());
      Persistent::pause(stop, due - Clock::now());
    }
    return {};
  }

  void deliver(Frame frame) {
    frame.stamp = clock_.stamp(frame.stamp);
    thread_.well();
    sink_.frame(std::move(frame));
  }

  std::string path_;
  int baud_;
  Setup setup_;
  DeviceSink sink_;
  std::string introduced_;
  Assembly assembly_;
  FrameClock clock_;
  Persistent thread_;  // last: joined before the rest goes
};

}  // namespace

Expected<std::unique_ptr<Device>> create_nest_of_birds(const DeviceOptions& options) {
  Setup setup;
  const auto format = bird::format_of_name(options.format);
  if (!format || *format < bird::Format::position_angles)
    return fail("'" + options.format + "' is no record with position and orientation",
                "glove.format", "choose position_angles, position_matrix or position_quaternion");
  const auto* hemisphere = bird::find_hemisphere(options.hemisphere);
  if (!hemisphere)
    return fail("there is no hemisphere '" + options.hemisphere + "'", "glove.hemisphere",
                "choose front, rear, left, right, upper or lower");
  if (options.range != 36 && options.range != 72 && options.range != 144)
    return fail("the tracker knows ranges of 36, 72 and 144 inches", "glove.range");
  if (options.mode != "stream" && options.mode != "point")
    return fail("'" + options.mode + "' is no mode", "glove.mode", "choose stream or point");
  if (!(options.rate >= 1 && options.rate <= 1000))
    return fail("the rate must be 1 to 1000 Hz", "glove.rate");
  if (options.port.empty())
    return fail("no port is named", "glove.port", "name one such as /dev/ttyUSB0");
  if (options.baud < 2400 || options.baud > 115200)
    return fail("the tracker knows 2400 to 115200 bits per second", "glove.baud");
  if (options.sites.empty() || options.sites.size() > bird::max_units)
    return fail(fmt::format("1 to {} sensors are possible", bird::max_units), "glove.sites");
  setup.sensors = static_cast<int>(options.sites.size());
  setup.format = *format;
  setup.range = options.range * bird::inch;
  setup.hemisphere = *hemisphere;
  setup.point = options.mode == "point";
  setup.rate = options.rate;
  setup.buttons = options.buttons;
  return std::make_unique<NestOfBirds>(options.port, options.baud, options.sites, setup);
}

std::unique_ptr<Emulator> emulate_nest_of_birds(const DeviceOptions& options) {
  return std::make_unique<bird::Emulator>(
      bird::EmulatorOptions{.sites = options.sites,
                            .extended = options.range == 144,
                            .left_to_right_T = left_to_right(options.X_WT)});
}

}  // namespace prehend::glove
