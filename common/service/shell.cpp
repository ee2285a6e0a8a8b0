#include "common/service/shell.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <mutex>
#include <utility>

#include "common/base/clock.hpp"
#include "common/base/log.hpp"
#include "common/base/log_format.hpp"
#include "common/base/paths.hpp"
#include "common/base/random.hpp"
#include "common/dds/dds_log.hpp"
#include "common/dds/security.hpp"
#include "common/dds/topics.hpp"
#include "common/service/instance.hpp"
#include "common/service/lockstep_loop.hpp"
#include "common/service/membership.hpp"
#include "common/service/pulse.hpp"
#include "common/service/rejoin.hpp"
#include "common/service/restart.hpp"
#include "common/service/status_publisher.hpp"
#include "common/service/supervisor.hpp"
#include "common/service/task_queue.hpp"
#include "common/service/watchdog.hpp"
#include "common/tool/program.hpp"

namespace prehend::service {

namespace fdds = eprosima::fastdds::dds;

namespace {

struct Arguments {
  std::string config;
  std::vector<std::string> overrides;
  bool lockstep = false, verbose = false;
};

Expected<Arguments> parse(int argc, char** argv, const Shell::Options& options) {
  Arguments made;
  made.config = (share_directory() / "lab.toml").string();
  CLI::App app(options.description, "prehend-" + options.name);
  app.add_option("--config", made.config, "the lab's configuration file")->capture_default_str();
  app.add_option("--set", made.overrides, "override: table.key=value (repeatable)")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  app.add_flag("--lockstep", made.lockstep, "follow lab/clock instead of the system clock");
  app.add_flag("--verbose", made.verbose, "say more");
  // It has said what there is to say.
  if (const auto ended = tool::parse(app, argc, argv))
    return fail({}, {}, {}, static_cast<Exit>(*ended));
  return made;
}

void warn_of_expiry(const dds::Keys* keys, Time now) {
  if (keys && keys->expires - now < dds::expiry_warning)
    log::warning("{}: expires in {:.1f} days (renew it with `prehend keys renew`)",
                 keys->folder.string(), to_seconds(keys->expires - now) / 86400);
}

}  // namespace

struct Shell::State {
  State(int argc, char** argv, Options o) : options(std::move(o)), restart(argc, argv) {}

  Options options;
  Restart restart;
  Config config;
  Status status;
  Supervisor supervisor;
  bool lockstep = false;
  std::optional<Error> not_joined;

  std::mutex exclusive;  // held while anything of the service runs; guards what follows
  bool running = false;
  Inbox inbox;
  LockstepLoop::Published published;
  std::function<void(Time)> tick;
  Duration period{};

  TaskQueue tasks;
  std::atomic<bool> stopping = false;
  std::atomic<Exit> exit = exit_done;
  std::atomic<bool> again = false;  // start anew after the end
  std::string revoked;              // the list of revoked keys that has been spoken of last
  Rejoin rejoin;
  std::function<bool()> moves_hand;
  bool list_is_old = false;  // as has been said
  bool shut = false;         // likewise: nobody else can join

  std::vector<std::unique_ptr<fdds::DataReaderListener>> listeners;
  std::unique_ptr<ClockSync> clock_sync;  // live only
  // Goes before all that its threads may still touch.
  std::optional<dds::Participant> participant;
  std::optional<StatusPublisher> status_publisher;
  std::optional<LockstepLoop> cycles;  // in lockstep only
  std::optional<Watchdog> watchdog;
  std::unique_ptr<Pulse> pulse;

  bool may_restart() const { return options.restarts && !lockstep; }

  void stop() {
    stopping = true;
    tasks.wake();
  }

  Duration clock_step() const { return clock_sync ? clock_sync->clock_step() : Duration::zero(); }

  Duration short_while() const {
    return seconds(Random(::getpid()).uniform(0, 1) * to_seconds(Rejoin::max_delay));
  }

  /// Fast DDS reads the list of revoked keys only when it joins; and then it has room for
  /// handshakes again. True: join anew.
  bool must_join_anew(Time now) {
    if (!participant->keys()) return false;
    say_how_old_the_list_is(now);
    const bool busy = moves_hand && moves_hand();
    if (!shut && dds::handshakes_are_used_up()) {
      shut = true;
      log::error("Fast DDS has no room for handshakes left: nobody else can join{}",
                 may_restart() ? "; joining anew when the hand rests" : " until a restart");
      if (may_restart()) rejoin.ask(now, short_while());
    }
    if (const auto list = dds::newer_list(*participant->keys()); list && *list != revoked) {
      revoked = *list;
      if (!may_restart())
        log::warning("the list of revoked keys has changed; it counts here after a restart");
      else if (busy)
        log::warning("the list of revoked keys has changed; it counts here when the hand rests");
      if (may_restart()) rejoin.ask(now, short_while());
    }
    if (!rejoin.is_due(now, busy)) return false;
    log::info("{}: joining anew",
              shut ? "nobody else could join" : "the list of revoked keys has changed");
    return true;
  }

  void say_how_old_the_list_is(Time now) {
    const auto limit = seconds(86400 * config.number("keys.revocation_max_age"));
    const auto trouble = dds::old_list(*participant->keys(), limit, now);
    if (list_is_old == trouble.has_value()) return;
    list_is_old = trouble.has_value();
    status.note(trouble ? trouble->message() : std::string());
    if (trouble) log::warning("{}", trouble->message());
  }

  /// A peer that was lost is still there.
  void join_anew() {
    if (!may_restart() || stopping) return;
    log::warning("a peer was lost and is still there: joining anew");
    again = true;
    stop();
  }

  void watch() {
    watchdog.emplace(Watchdog::Options{.on_stop = [this] { stop(); },
                                       .on_deadlock =
                                           [this] {
                                             if (options.restarts && !stopping) restart.now();
                                             std::_Exit(exit_broken);
                                           },
                                       .on_stranded = [this] { join_anew(); },
                                       .looks_for_deadlock = !lockstep});
  }

  /// From now on it answers who asks whether it is alive, as soon as it runs.
  void answer() {
    auto made = Pulse::create(pulse_name(config, options.name),
                              [this](std::function<void()> task) { tasks.post(std::move(task)); });
    if (made)
      pulse = std::move(*made);
    else
      log::warning("`prehend alive {}` is not answered here: {}", options.name,
                   made.error().message());
  }

  Expected<void> join() {
    dds::ParticipantOptions joining = membership(config, options.name, options.role);
    joining.lockstep = lockstep;
    auto joined = dds::Participant::create(joining);
    if (!joined) return tl::unexpected(joined.error());
    participant.emplace(std::move(*joined));
    const Time started = process_now();
    warn_of_expiry(participant->keys(), started);
    if (const dds::Keys* keys = participant->keys(); keys && config.flag("keys.refuse_old_list"))
      if (auto trouble = dds::old_list(
              *keys, seconds(86400 * config.number("keys.revocation_max_age")), started))
        return tl::unexpected(std::move(*trouble));
    const std::string host = host_name();
    auto publisher = StatusPublisher::create(*participant, options.name, host,
                                             instance_of(config, options.name), started);
    if (!publisher) return tl::unexpected(publisher.error());
    status_publisher.emplace(std::move(*publisher));
    // Keys of before there was this topic do not permit it, and the rest works.
    if (auto told = status_publisher->tell_settings(config.overridden()); !told)
      log::warning("{}; no recording knows how this was started", told.error().message());
    watch();
    answer();
    if (lockstep) {
      auto loop = LockstepLoop::create(*participant, options.name);
      if (!loop) return tl::unexpected(loop.error());
      cycles.emplace(std::move(*loop));
      return {};
    }
    auto sync = ClockSync::create(*participant, status_publisher->service(), host, started);
    if (!sync) return tl::unexpected(sync.error());
    clock_sync = std::move(*sync);
    return {};
  }
};

Shell::Shell(std::unique_ptr<State> state) : state_(std::move(state)) {}

Shell::~Shell() {
  state_->participant.reset();  // ends the threads that hand over samples
}

Expected<std::unique_ptr<Shell>> Shell::create(int argc, char** argv, const Options& options) {
  log::set_name(options.name);
  auto arguments = parse(argc, argv, options);
  if (!arguments) return tl::unexpected(arguments.error());
  log::set_verbose(arguments->verbose);
  auto config = Config::load(arguments->config, arguments->overrides);
  if (!config) {
    Error error = config.error();
    error.exit = exit_wrong_use;
    return tl::unexpected(std::move(error));
  }
  log::set_rig(config->text("lab.rig"));
  block_stop_signals();
  auto state = std::make_unique<State>(argc, argv, options);
  state->config = std::move(*config);
  state->lockstep = arguments->lockstep || state->config.flag("lab.lockstep");
  State* const raw = state.get();
  std::unique_ptr<Shell> shell(new Shell(std::move(state)));
  if (auto joined = raw->join(); !joined) return tl::unexpected(joined.error());
  if (raw->lockstep)
    shell->subscribe(dds::lab_clock,
                     std::function([raw](const v2::LabClock& cycle, const dds::SampleInfo& info) {
                       if (!info.gone) raw->cycles->add(cycle);
                     }));
  return shell;
}

Expected<std::unique_ptr<Shell>> Shell::create(std::vector<std::string> arguments,
                                               const Options& options) {
  arguments.insert(arguments.begin(), "prehend-" + options.name);
  std::vector<char*> pointers;
  for (std::string& text : arguments) pointers.push_back(text.data());
  return create(static_cast<int>(pointers.size()), pointers.data(), options);
}

ClockSync::Ahead Shell::ahead(const dds::SampleInfo& info) const {
  return state_->clock_sync ? state_->clock_sync->ahead(info) : ClockSync::Ahead{};
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
  return state_->lockstep ? state_->cycles->now() : process_now();
}
std::string Shell::writer_of(const dds::SampleInfo& info) const {
  std::string service = state_->clock_sync ? state_->clock_sync->service_of(info) : std::string();
  return service.empty() ? fmt::format("{:02x}", fmt::join(info.participant, ".")) : service;
}
std::optional<dds::Role> Shell::role_of(const dds::SampleInfo& info) const {
  return state_->participant->role_of(info.participant);
}
std::map<dds::GuidPrefix, dds::Peers::Presented> Shell::present() const {
  return state_->participant->present();
}
dds::Participant& Shell::participant() {
  return *state_->participant;
}

void Shell::not_joined(const Error& error) {
  if (!state_->not_joined) state_->not_joined = error;
}

Input& Shell::add_input(std::string_view topic) {
  const std::scoped_lock lock(state_->exclusive);
  return state_->inbox.add(topic);
}

void Shell::keep(std::unique_ptr<fdds::DataReaderListener> listener) {
  state_->listeners.push_back(std::move(listener));
}

void Shell::arrive(Input& input, std::vector<Arrival> arrivals) {
  State& state = *state_;
  {
    const std::scoped_lock lock(state.exclusive);
    const bool at_once = state.lockstep ? input.topic == dds::lab_clock.name : state.running;
    for (Arrival& arrival : arrivals)
      if (at_once)
        arrival.deliver();
      else
        input.add(std::move(arrival));
  }
  if (state.lockstep) state.tasks.wake();
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
  state_->tasks.post(std::move(task));
}

void Shell::exclusively(const std::function<void()>& task) {
  const std::scoped_lock lock(state_->exclusive);
  if (state_->running) task();
}

void Shell::busy_while(std::function<bool()> moves_hand) {
  state_->moves_hand = std::move(moves_hand);
}

void Shell::stop(Exit exit) {
  state_->exit = exit;
  state_->stop();
}

bool Shell::stopping() const {
  return state_->stopping;
}

/// Publishes the status when it is due, and then looks for what else happens seldom; tells the
/// supervisor that the loop runs. Says when the next of these is due.
Time Shell::beat(Time now) {
  State& state = *state_;
  const bool due = now >= state.status_publisher->next();
  const Time next = state.status_publisher->beat(now, state.status, state.clock_step());
  if (due && state.must_join_anew(now)) state.again = state.stopping = true;
  return std::min(next, state.supervisor.beat(now));
}

void Shell::run_live() {
  State& state = *state_;
  std::unique_lock lock(state.exclusive);
  Time next_tick = process_now();
  state.running = true;
  std::vector<Arrival> early = state.inbox.take_all();
  deliver(early);
  while (!state.stopping) {
    state.tasks.run();
    if (const Time now = process_now(); state.tick && now >= next_tick) {
      state.tick(now);
      // A late tick is not made up for: the next one sees all the time that has passed.
      next_tick = std::max(next_tick + state.period, now);
    }
    const Time then = process_now();
    Time wake_at = std::min(beat(then), state.clock_sync->beat(then));
    if (state.tick) wake_at = std::min(wake_at, next_tick);
    if (state.stopping) break;
    lock.unlock();
    state.tasks.wait(wake_at - process_now());
    lock.lock();
  }
  state.running = false;
}

void Shell::run_in_lockstep() {
  State& state = *state_;
  std::unique_lock lock(state.exclusive);
  state.running = true;
  while (!state.stopping) {
    state.tasks.run();
    while (state.cycles->run_cycle(state.inbox, state.tick, state.published)) {
    }
    const Time wake_at = beat(process_now());
    if (state.stopping) break;
    lock.unlock();
    state.tasks.wait(wake_at - process_now());
    lock.lock();
  }
  state.running = false;
}

Expected<Exit> Shell::run() {
  State& state = *state_;
  if (state.not_joined) return tl::unexpected(*state.not_joined);
  state.status_publisher->publish(process_now(), state.status, state.clock_step());
  state.lockstep ? run_in_lockstep() : run_live();
  if (state.again) {
    state.participant.reset();
    state.restart.now();
  }
  state.supervisor.stopping();
  if (state.options.restarts) log::info("stopped");
  return state.exit.load();
}

}  // namespace prehend::service
