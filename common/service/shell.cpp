#include "shell.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cerrno>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <fstream>
#include <iostream>
#include <limits>
#include <mutex>
#include <prehend/base/clock.hpp>
#include <prehend/base/log.hpp>
#include <prehend/base/paths.hpp>
#include <prehend/clock/peers.hpp>
#include <prehend/dds/gate.hpp>
#include <prehend/dds/guarded_transport.hpp>
#include <prehend/dds/security.hpp>
#include <thread>

#include "membership.hpp"

namespace prehend::service {

namespace fdds = eprosima::fastdds::dds;

namespace {

/// Bytes of memory in use, from the kernel.
double resident_memory() {
  std::ifstream statm("/proc/self/statm");
  long total = 0, resident = 0;
  statm >> total >> resident;
  return static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

std::string host_name() {
  char name[65] = {};
  gethostname(name, 64);
  return name;
}

/// «+3600.000 s», for people.
std::string signed_seconds(Duration duration) {
  return fmt::format("{:+.3f} s", to_seconds(duration));
}

/// Waited for by a thread of its own: a handler must not touch what wakes run().
sigset_t stop_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGTERM);
  sigaddset(&set, SIGINT);
  return set;
}

constexpr Duration beacon_period = std::chrono::seconds(1);
/// Others find us soon after the start.
constexpr Duration early_beacon_period = std::chrono::milliseconds(100);
constexpr Duration early = std::chrono::seconds(2);
constexpr Duration least_between_beacons = std::chrono::milliseconds(20);
constexpr Duration noticed_step = std::chrono::milliseconds(100);

}  // namespace

/// What has come on a topic and is not handed over yet: live only before run(), in lockstep until
/// due.
struct Shell::Input {
  std::string_view topic;
  std::vector<Arrival> waiting;
  std::uint64_t received = 0;
};

struct Shell::State {
  Options options;
  Config config;
  Status status;
  bool lockstep = false;

  std::mutex exclusive;  // held while anything of the service runs; guards what follows
  bool running = false;
  std::vector<std::unique_ptr<Input>> inputs;
  std::deque<v1::LabClock> cycles;  // lockstep, not yet run
  std::map<std::string, std::uint64_t, std::less<>> published;
  std::function<void(Time)> tick;
  Duration period{};
  Time next_tick{}, next_status{}, next_beacon{}, started{}, clock{};

  std::mutex wake_mutex;  // guards what follows; taken inside of `exclusive`, never around it
  std::condition_variable wake_condition;
  bool woken = false;
  std::deque<std::function<void()>> tasks;

  mutable std::mutex clocks_mutex;     // guards what follows; innermost
  std::optional<clock::Peers> clocks;  // live only
  Time last_beacon{};
  Duration clock_step{};

  std::atomic<bool> stopping = false, left = false;
  std::atomic<int> exit_code = 0;

  v1::ServiceStatus status_message;
  std::map<dds::Verdict, std::uint64_t> dropped;  // packets, as far as the status tells
  std::vector<std::unique_ptr<fdds::DataReaderListener>> listeners;
  // Goes before all that its threads may still touch.
  std::optional<dds::Participant> participant;
  std::optional<dds::Writer<v1::ServiceStatus>> status_writer;
  std::map<std::string, std::uint64_t> refused;  // peers, as far as the status tells
  std::vector<std::string> command;              // that started this process
  std::string revoked;  // the list of revoked keys that has been spoken of last
  std::optional<dds::Writer<v1::LabProgress>> progress_writer;
  std::optional<dds::Writer<v1::ClockBeacon>> beacon_writer;
  std::thread signals;

  void wake() {
    {
      const std::scoped_lock lock(wake_mutex);
      woken = true;
    }
    wake_condition.notify_one();
  }

  /// Fast DDS reads the list of revoked keys only when it joins. True: join anew.
  bool list_has_changed() {
    if (!participant->keys()) return false;
    const auto list = dds::newer_list(*participant->keys());
    if (!list || *list == revoked) return false;
    revoked = *list;
    if (options.restarts && !lockstep) {
      log::info("the list of revoked keys has changed: joining anew");
      return true;
    }
    log::warning("the list of revoked keys has changed; it counts here after a restart");
    return false;
  }

  /// The same program with the same arguments in this process, which keeps its number.
  [[noreturn]] void start_anew() {
    std::vector<char*> arguments;
    for (std::string& text : command) arguments.push_back(text.data());
    arguments.push_back(nullptr);
    const sigset_t set = stop_signals();
    pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
    ::close_range(3, ~0u, 0);
    ::execv("/proc/self/exe", arguments.data());
    log::error("cannot start anew: {}", std::strerror(errno));
    std::_Exit(3);
  }

  /// Waits for signals to stop, and looks whether Fast DDS has locked itself up: then nothing of it
  /// can be used any more, not even to leave.
  void watch() {
    const sigset_t waited = stop_signals();
    const timespec while_waiting{0, 500'000'000};
    dds::DeafnessWatch deafness;
    while (!left) {
      if (sigtimedwait(&waited, nullptr, &while_waiting) > 0) {
        stopping = true;
        wake();
      } else if (!lockstep && deafness.look()) {
        log::error("Fast DDS has locked itself up and receives nothing any more");
        if (options.restarts && !stopping) start_anew();
        std::_Exit(3);
      }
    }
  }
};

Shell::Shell(std::unique_ptr<State> state) : state_(std::move(state)) {}

Shell::~Shell() {
  state_->participant.reset();  // ends the threads that hand over samples
  // The watcher waits for a signal; one of our own lets it go.
  if (state_->signals.joinable()) {
    state_->left = true;
    pthread_kill(state_->signals.native_handle(), SIGTERM);
    state_->signals.join();
  }
}

std::unique_ptr<Shell> Shell::create(int argc, char** argv, const Options& options,
                                     int& exit_code) {
  CLI::App app(options.description, "prehend-" + options.name);
  std::string config_file = (share_directory() / "lab.toml").string();
  std::vector<std::string> overrides;
  bool lockstep = false, verbose = false;
  app.add_option("--config", config_file, "the lab's configuration file")->capture_default_str();
  app.add_option("--set", overrides, "override: table.key=value (repeatable)")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  app.add_flag("--lockstep", lockstep, "follow lab/clock instead of the system clock");
  app.add_flag("--verbose", verbose, "say more");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    exit_code = app.exit(error) == 0 ? 0 : 2;
    return nullptr;
  }
  log::set_name(options.name);
  log::set_verbose(verbose);

  auto config = Config::load(config_file, overrides);
  if (!config) {
    log::error("{}", config.error().message());
    exit_code = 2;
    return nullptr;
  }

  // Before any thread starts, so that all of them inherit it and only the watcher gets the signals.
  const sigset_t set = stop_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);

  auto state = std::make_unique<State>();
  state->options = options;
  state->config = std::move(*config);
  state->lockstep = lockstep || state->config.flag("lab.lockstep");
  dds::ParticipantOptions joining = membership(state->config, options.name, options.role);
  joining.lockstep = state->lockstep;
  auto participant = dds::Participant::create(joining);
  if (!participant) {
    log::error("{}", participant.error().message());
    exit_code = 3;
    return nullptr;
  }
  state->participant.emplace(std::move(*participant));
  state->started = process_now();
  if (const dds::Keys* keys = state->participant->keys();
      keys && keys->expires - state->started < dds::expiry_warning)
    log::warning("{}: expires in {:.1f} days (renew it with `prehend keys add --renew`)",
                 keys->folder.string(), to_seconds(keys->expires - state->started) / 86400);
  state->command.assign(argv, argv + argc);

  auto status_writer = state->participant->writer(dds::service_status);
  if (!status_writer) refuse(status_writer.error());
  state->status_writer.emplace(std::move(*status_writer));
  const std::string host = host_name();
  state->status_message.name(options.name.c_str());
  state->status_message.host(host.substr(0, 64).c_str());
  state->status_message.service(
      (options.name + "@" + host + "/" + std::to_string(getpid())).substr(0, 128).c_str());

  State* raw = state.get();
  state->signals = std::thread([raw] { raw->watch(); });
  exit_code = 0;
  std::unique_ptr<Shell> shell(new Shell(std::move(state)));
  if (raw->lockstep) {
    auto writer = raw->participant->writer(dds::lab_progress);
    if (!writer) refuse(writer.error());
    raw->progress_writer.emplace(std::move(*writer));
    shell->subscribe(dds::lab_clock, [raw](const v1::LabClock& cycle, const dds::SampleInfo& info) {
      if (!info.gone) raw->cycles.push_back(cycle);
    });
  } else {
    shell->begin_beacons(host);
  }
  return shell;
}

/// Hears beacons in the thread that receives them, so that nothing of ours counts as the network's
/// delay.
class BeaconListener final : public fdds::DataReaderListener {
 public:
  using Hear = std::function<void(const dds::Sample<v1::ClockBeacon>&, Time received)>;
  explicit BeaconListener(Hear hear) : hear_(std::move(hear)) {}
  void on_data_available(fdds::DataReader* raw) override {
    const Time received = process_now();
    if (!reader_) reader_.emplace(raw);
    for (const auto& sample : reader_->take())
      if (!sample.info.gone) hear_(sample, received);
  }

 private:
  Hear hear_;
  std::optional<dds::Reader<v1::ClockBeacon>> reader_;
};

void Shell::begin_beacons(const std::string& host) {
  State& state = *state_;
  state.clocks.emplace(state.status_message.service().to_string(), host);
  auto writer = participant().writer(dds::lab_beacon);
  if (!writer) refuse(writer.error());
  state.beacon_writer.emplace(std::move(*writer));
  auto listener = std::make_unique<BeaconListener>(
      [this, &state](const dds::Sample<v1::ClockBeacon>& sample, Time received) {
        clock::Peers::Heard heard;
        {
          const std::scoped_lock lock(state.clocks_mutex);
          heard = state.clocks->hear(sample.data, sample.info.participant, received);
        }
        if (heard.step)
          log::warning("the clock of {} was set by {}; its stamps are moved to ours",
                       sample.data.service().to_string(), signed_seconds(*heard.step));
        if (heard.answer) send_beacon();
      });
  auto* raw = listener.get();
  keep(std::move(listener));
  if (auto made = participant().reader(dds::lab_beacon, raw); !made) refuse(made.error());
}

void Shell::send_beacon() {
  State& state = *state_;
  v1::ClockBeacon beacon;
  {
    const std::scoped_lock lock(state.clocks_mutex);
    const Time now = process_now();
    if (now - state.last_beacon < least_between_beacons) return;
    state.last_beacon = now;
    const Duration step = clock_step();
    if (std::chrono::abs(step - state.clock_step) > noticed_step) {
      state.clock_step = step;
      log::warning("the system's clock was set {} away from this process, which keeps its own",
                   signed_seconds(step));
    }
    beacon = state.clocks->beacon(now, state.clock_step);
  }
  // Our own reader hears it within this call.
  state.beacon_writer->write(beacon);
}

Shell::Ahead Shell::ahead(const dds::SampleInfo& info) const {
  if (state_->lockstep) return {};
  const std::scoped_lock lock(state_->clocks_mutex);
  const Time now = process_now();
  return {state_->clocks->ahead(info.participant, now),
          state_->clocks->system_ahead(info.participant, now)};
}

const Config& Shell::config() const {
  return state_->config;
}
Status& Shell::status() {
  return state_->status;
}
bool Shell::lockstep() const {
  return state_->lockstep;
}
Time Shell::now() const {
  return state_->lockstep ? state_->clock : process_now();
}
dds::Participant& Shell::participant() {
  return *state_->participant;
}

void Shell::refuse(const Error& error) {
  log::error("{}", error.message());
  std::_Exit(3);
}

Shell::Input& Shell::add_input(std::string_view topic) {
  const std::scoped_lock lock(state_->exclusive);
  auto& inputs = state_->inputs;
  // Equal stamps are handed over in the order of the topics' names, whoever subscribed first.
  const auto place = std::find_if(inputs.begin(), inputs.end(),
                                  [&](const auto& input) { return input->topic > topic; });
  return **inputs.insert(place, std::make_unique<Input>(Input{topic, {}, 0}));
}

void Shell::keep(std::unique_ptr<fdds::DataReaderListener> listener) {
  state_->listeners.push_back(std::move(listener));
}

void Shell::arrive(Input& input, std::vector<Arrival> arrivals) {
  State& state = *state_;
  {
    const std::scoped_lock lock(state.exclusive);
    const bool at_once = state.lockstep ? input.topic == dds::lab_clock.name : state.running;
    for (Arrival& arrival : arrivals) {
      arrival.index = input.received++;
      if (at_once)
        arrival.deliver();
      else
        input.waiting.push_back(std::move(arrival));
    }
  }
  if (state.lockstep) state.wake();
}

std::function<void()> Shell::count_output(std::string_view topic) {
  std::uint64_t& count = state_->published[std::string(topic)];
  return [&count] { ++count; };
}

void Shell::on_tick(Duration period, std::function<void(Time)> tick) {
  state_->period = period;
  state_->tick = std::move(tick);
}

void Shell::post(std::function<void()> task) {
  {
    const std::scoped_lock lock(state_->wake_mutex);
    state_->tasks.push_back(std::move(task));
    state_->woken = true;
  }
  state_->wake_condition.notify_one();
}

void Shell::exclusively(const std::function<void()>& task) {
  const std::scoped_lock lock(state_->exclusive);
  if (state_->running) task();
}

void Shell::stop(int exit_code) {
  state_->exit_code = exit_code;
  state_->stopping = true;
  state_->wake();
}

int Shell::run() {
  State& state = *state_;
  const auto publish_status = [&](Time now) {
    for (const dds::Dropped& dropped : dds::dropped_packets()) {
      const auto reason = dds::verdict_names[static_cast<std::size_t>(dropped.reason)];
      std::uint64_t& told = state.dropped[dropped.reason];
      if (told == 0) log::warning("dropped: {}, from {}", reason, dropped.last_source);
      state.status.drop(reason, dropped.count - std::exchange(told, dropped.count));
    }
    for (const auto& [peer, count] : state.participant->refused()) {
      std::uint64_t& told = state.refused[peer];
      if (told == 0) log::warning("peer refused: {}", peer);
      state.status.drop("peer refused: " + peer, count - told);
      told = count;
    }
    state.status.fill(state.status_message, now);
    state.status_message.uptime(to_seconds(now - state.started));
    state.status_message.resident(resident_memory());
    if (state.status_message.message().size() == 0) {
      const std::scoped_lock clocks(state.clocks_mutex);
      if (state.clock_step != Duration::zero())
        state.status_message.message(
            ("the system's clock was set " + signed_seconds(state.clock_step) +
             " away from this process, which keeps its own until it is started anew")
                .c_str());
    }
    state.status_writer->write(state.status_message);
    state.next_status = now + std::chrono::seconds(1);
  };
  const auto run_tasks = [&] {
    std::deque<std::function<void()>> tasks;
    {
      const std::scoped_lock lock(state.wake_mutex);
      tasks.swap(state.tasks);
    }
    for (auto& task : tasks) task();
  };
  /// In the order (stamp, topic, sequence): inputs are sorted by topic, arrivals by sequence.
  const auto deliver = [](std::vector<Arrival>& due) {
    std::stable_sort(due.begin(), due.end(),
                     [](const auto& a, const auto& b) { return a.stamp_ns < b.stamp_ns; });
    for (Arrival& arrival : due) arrival.deliver();
  };

  /// One lockstep cycle, if everything it speaks of has come. False: wait for more.
  const auto run_cycle = [&]() -> bool {
    if (state.cycles.empty()) return false;
    const v1::LabClock& cycle = state.cycles.front();
    const auto counted = [&](const Input& input) {
      for (const auto& count : cycle.published())
        if (input.topic == std::string_view(count.topic().c_str())) return count.count();
      return std::uint64_t{0};
    };
    for (const auto& input : state.inputs)
      if (input->received < counted(*input)) return false;
    state.clock = from_ns(cycle.stamp_ns());
    // Of each topic only as many as the clock has counted: later ones belong to later cycles.
    std::vector<Arrival> due;
    std::uint32_t waiting = 0;
    for (const auto& input : state.inputs) {
      std::vector<Arrival> kept;
      for (Arrival& arrival : input->waiting) {
        const bool is_due = arrival.index < counted(*input) && arrival.stamp_ns <= cycle.stamp_ns();
        (is_due ? due : kept).push_back(std::move(arrival));
      }
      waiting += static_cast<std::uint32_t>(kept.size());
      input->waiting = std::move(kept);
    }
    deliver(due);
    if (state.tick) state.tick(state.clock);
    v1::LabProgress progress;
    progress.service(state.options.name.c_str());
    progress.cycle(cycle.cycle());
    progress.stamp_ns(cycle.stamp_ns());
    progress.waiting(waiting);
    for (const auto& [topic, count] : state.published) {
      v1::TopicCount entry;
      entry.topic(topic.c_str());
      entry.count(count);
      progress.published().push_back(entry);
    }
    state.progress_writer->write(progress);
    state.cycles.pop_front();
    return true;
  };

  bool again = false;
  std::unique_lock lock(state.exclusive);
  publish_status(process_now());
  state.next_tick = process_now();
  state.running = true;
  if (!state.lockstep) {
    std::vector<Arrival> early;
    for (const auto& input : state.inputs)
      for (Arrival& arrival : input->waiting) early.push_back(std::move(arrival));
    deliver(early);
  }
  while (!state.stopping) {
    run_tasks();
    if (state.lockstep) {
      while (run_cycle()) {
      }
    } else if (const Time now = process_now(); state.tick && now >= state.next_tick) {
      state.tick(now);
      // A late tick is not made up for: the next one sees all the time that has passed.
      state.next_tick = std::max(state.next_tick + state.period, now);
    }
    const Time then = process_now();
    if (then >= state.next_status) {
      publish_status(then);
      if (state.list_has_changed()) again = state.stopping = true;
    }
    if (!state.lockstep && then >= state.next_beacon) {
      send_beacon();
      state.next_beacon =
          then + (then - state.started < early ? early_beacon_period : beacon_period);
    }

    Time wake_at = state.next_status;
    if (!state.lockstep) wake_at = std::min(wake_at, state.next_beacon);
    if (state.tick && !state.lockstep) wake_at = std::min(wake_at, state.next_tick);
    lock.unlock();
    {
      std::unique_lock sleep(state.wake_mutex);
      state.wake_condition.wait_for(sleep, wake_at - process_now(),
                                    [&] { return state.woken || state.stopping; });
      state.woken = false;
    }
    lock.lock();
  }
  state.running = false;
  if (again) {
    lock.unlock();
    state.participant.reset();
    state.start_anew();
  }
  log::info("stopped");
  return state.exit_code;
}

}  // namespace prehend::service
