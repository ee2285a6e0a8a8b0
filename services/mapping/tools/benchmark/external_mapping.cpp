#include "services/mapping/tools/benchmark/external_mapping.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "common/convert/convert.hpp"
#include "common/dds/topics.hpp"
#include "common/service/membership.hpp"
#include "common/stage/conductor.hpp"
#include "common/stage/process.hpp"
#include "services/mapping/tools/benchmark/lab_messages.hpp"
#include "services/mapping/tools/benchmark/own_by_messages.hpp"

namespace prehend::mapping {

namespace {

constexpr std::chrono::milliseconds patience{20'000};  // with one who comes, or answers
constexpr Duration look = std::chrono::milliseconds(20);

std::string own_rig() {
  static std::atomic<int> count = 0;
  return fmt::format("benchmark-{}-{}", ::getpid(), ++count);
}

/// Commands as they come, from the thread that receives them.
class Inbox {
 public:
  void add(dds::RawSample&& sample) {
    {
      const std::scoped_lock lock(mutex_);
      samples_.push_back(std::move(sample));
      ++received_;
    }
    news_.notify_all();
  }
  /// False when fewer have come in time, since the beginning.
  bool wait_for(std::uint64_t count) {
    std::unique_lock lock(mutex_);
    return news_.wait_for(lock, patience, [&] { return received_ >= count; });
  }
  std::vector<dds::RawSample> take() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(samples_, {});
  }

 private:
  std::mutex mutex_;
  std::condition_variable news_;
  std::vector<dds::RawSample> samples_;
  std::uint64_t received_ = 0;
};

}  // namespace

struct ExternalMapping::State {
  ExternalOptions options;
  std::optional<stage::Process> process;
  std::optional<dds::Participant> participant;
  std::optional<stage::Conductor> conductor;
  Inbox inbox;
  std::optional<dds::RawWriter> postures, detections, states, gates;
  std::unique_ptr<dds::RawReader> commands;
  std::uint64_t sequence = 0;
  Duration beginning = take_beginning;
  Duration lag{};

  Expected<void> join(const std::string& rig) {
    dds::ParticipantOptions member = service::membership(*options.lab, "benchmark", "replayer");
    member.rig = rig;
    member.lockstep = options.lockstep;
    auto joined = dds::Participant::create(member);
    if (!joined) return tl::unexpected(joined.error());
    participant.emplace(std::move(*joined));
    for (auto [place, topic] : {std::pair(&postures, dds::raw_topic(dds::hand_posture)),
                                std::pair(&detections, dds::raw_topic(dds::object_detection)),
                                std::pair(&states, dds::raw_topic(dds::robot_state))}) {
      auto made = dds::RawWriter::create(*participant, topic);
      if (!made) return tl::unexpected(made.error());
      place->emplace(std::move(*made));
    }
    auto reader =
        dds::RawReader::create(*participant, dds::raw_topic(dds::robot_command),
                               [this](dds::RawSample&& sample) { inbox.add(std::move(sample)); });
    if (!reader) return tl::unexpected(reader.error());
    commands = std::move(*reader);
    if (!options.lockstep) return tell_of_gate();
    auto made = stage::Conductor::create(*participant, {options.service});
    if (!made) return tl::unexpected(made.error());
    conductor.emplace(std::move(*made));
    return {};
  }

  /// Before every robot hand is a gate, which says that the hand is somewhere already. A mapping
  /// that hears nothing of it may wait for it.
  Expected<void> tell_of_gate() {
    auto made = dds::RawWriter::create(*participant, dds::raw_topic(dds::robot_gate));
    if (!made) return tl::unexpected(made.error());
    gates.emplace(std::move(*made));
    v1::GateState open;
    open.hand(benchmarked_hand_name);
    open.stamp_ns(to_ns(std::chrono::system_clock::now()));
    open.placed(true);
    write(*gates, dds::robot_gate, open);
    return {};
  }

  Expected<void> start(const std::string& rig) {
    auto started = stage::Process::start(
        {.command = {"/bin/sh", "-c", options.command},
         .log = options.log,
         .environment = {
             {"PREHEND_LAB_RIG", rig},
             {"PREHEND_LAB_DOMAIN", fmt::format("{}", options.lab->integer("lab.domain"))},
             {"PREHEND_LAB_LOCKSTEP", options.lockstep ? "true" : "false"}}});
    if (!started) return tl::unexpected(started.error());
    process.emplace(std::move(*started));
    return {};
  }

  /// That it has ended, with its last words.
  std::optional<Error> dead() {
    if (!process || !process->exit()) return std::nullopt;
    return Error{fmt::format("ended with code {}: {}", process->exit()->code,
                             stage::last_lines(options.log, 3)),
                 options.command,
                 {}};
  }

  bool is_there() {
    eprosima::fastdds::dds::PublicationMatchedStatus readers;
    postures->raw().get_publication_matched_status(readers);
    return readers.current_count > 0 && commands->writers() > 0;
  }

  Expected<void> wait() {
    const auto give_up = std::chrono::steady_clock::now() + patience;
    while (!is_there()) {
      if (const auto error = dead()) return tl::unexpected(*error);
      if (std::chrono::steady_clock::now() > give_up)
        return fail("nobody reads hand/posture and writes robot/command",
                    options.command.empty() ? options.lab->text("lab.rig") : options.command,
                    "does it run, in this domain and rig?");
      std::this_thread::sleep_for(look);
    }
    return {};
  }

  template <class P>
  void write(dds::RawWriter& writer, const dds::Topic<P>& topic, typename P::type message) {
    message.sequence_number(sequence++);
    // Live, latencies are told from when it was sent.
    writer.write(raw_sample(topic, message),
                 conductor ? from_ns(message.stamp_ns()) : Time(std::chrono::system_clock::now()));
    if (conductor) conductor->published(topic.name);
  }

  void say(const Told& told) {
    if (told.detection) write(*detections, dds::object_detection, to_message(*told.detection));
    if (told.state) write(*states, dds::robot_state, to_message(*told.state, options.model));
    if (told.posture) write(*postures, dds::hand_posture, to_message(*told.posture, options.user));
  }

  void take(std::vector<gate::Command>& made) {
    for (const dds::RawSample& sample : inbox.take()) {
      v2::HandCommand message;
      if (sample.kind != dds::RawSample::Kind::data ||
          !dds::decode(dds::robot_command, sample, message))
        continue;
      const auto X_WB = convert::from_message(message.X_WB());
      if (!X_WB) continue;  // as the robot's side does
      gate::WriterId writer{};
      std::copy_n(sample.writer.begin(), writer.size(), writer.begin());
      made.push_back(
          {writer,
           message.sequence_number(),
           from_ns(message.stamp_ns()) - beginning,
           message.hand().to_string(),
           message.model().to_string(),
           {convert::from_message(message.dof()), *X_WB, convert::from_message(message.effort())}});
    }
  }

  /// One cycle of lab/clock, and all that was commanded in it.
  Expected<void> cycle(const Told& told, Time now, std::vector<gate::Command>& made) {
    say(told);
    if (auto done = conductor->step(now + beginning, patience, [this] { return dead(); }); !done)
      return done;
    const auto totals = conductor->totals();
    const auto said = totals.find(std::string(dds::robot_command.name));
    if (said != totals.end() && !inbox.wait_for(said->second))
      return fail("commands were said to be published and did not come", "robot/command");
    take(made);
    return {};
  }

  Expected<void> in_lockstep(const Told& told, Time now, std::vector<gate::Command>& made) {
    // Within a cycle topics come by their names: the posture shall be answered with what was seen.
    if (told.detection || told.state)
      if (auto done = cycle({told.detection, told.state, {}}, now, made); !done) return done;
    if (told.posture) return cycle({{}, {}, told.posture}, now, made);
    return {};
  }

  Expected<void> live(const Told& told, Time now, std::vector<gate::Command>& made) {
    std::this_thread::sleep_until(
        std::chrono::time_point_cast<std::chrono::system_clock::duration>(now + beginning));
    lag = std::max(lag, Duration(std::chrono::system_clock::now() - (now + beginning)));
    say(told);
    take(made);
    if (const auto error = dead()) return tl::unexpected(*error);
    return {};
  }
};

ExternalMapping::ExternalMapping(std::unique_ptr<State> state) : state_(std::move(state)) {}

ExternalMapping::~ExternalMapping() {
  // What was seen in this take is not there in the next.
  if (state_->detections) {
    v1::ObjectDetection seen;
    seen.track(1);
    dds::RawSample gone = raw_sample(dds::object_detection, seen);
    gone.kind = dds::RawSample::Kind::disposed;
    state_->detections->write(gone, std::chrono::system_clock::now());
  }
  if (state_->process) state_->process->stop(std::chrono::seconds(3));
}

Expected<std::unique_ptr<ExternalMapping>> ExternalMapping::meet(const ExternalOptions& options) {
  auto state = std::make_unique<State>();
  state->options = options;
  const std::string rig = options.command.empty() ? options.lab->text("lab.rig") : own_rig();
  if (auto joined = state->join(rig); !joined) return tl::unexpected(joined.error());
  if (!options.command.empty())
    if (auto started = state->start(rig); !started) return tl::unexpected(started.error());
  if (auto there = state->wait(); !there) return tl::unexpected(there.error());
  if (!options.lockstep)
    state->beginning = std::chrono::system_clock::now().time_since_epoch() + 10 * look;
  return std::unique_ptr<ExternalMapping>(new ExternalMapping(std::move(state)));
}

Expected<std::vector<gate::Command>> ExternalMapping::answer(const Told& heard, Time now) {
  const Told told = at_date(heard, state_->beginning);
  std::vector<gate::Command> made;
  const auto done = state_->options.lockstep ? state_->in_lockstep(told, now, made)
                                             : state_->live(told, now, made);
  if (!done) return tl::unexpected(done.error());
  return made;
}

Duration ExternalMapping::lag() const {
  return state_->lag;
}

}  // namespace prehend::mapping
