#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/time_between.hpp"
#include "common/dds/participant.hpp"
#include "common/service/clock_sync.hpp"
#include "common/service/config.hpp"
#include "common/service/inbox.hpp"
#include "common/service/status.hpp"

namespace prehend::service {

/// The shell of every process: arguments, configuration, life cycle, input, time, status.
///
/// Use: run() of life_cycle.hpp, or create(), publish() and subscribe(), on_tick(), run().
/// Everything that is given to the shell is called between the start and the end of run(), one call
/// at a time. Only post(), exclusively() and status() may be used from other threads.
///
/// Live, a sample is handed over in the thread that received it (a change of threads would cost as
/// much as the whole hop), and the tick follows the system clock. In lockstep (lab.lockstep = true,
/// or --lockstep) inputs are handed over in the order (stamp, topic, writer, sequence) of what the
/// clock's cycle says has been published, then comes one tick, then lab/progress is answered;
/// nothing then depends on when messages arrive.
class Shell {
 public:
  struct Options {
    std::string name;         // of the service: glove, mapping, ...
    std::string description;  // first line of --help
    std::string role = {};    // what it is, and whose keys it takes; empty: its name
    /// It may be started anew in its place at any time, with the same arguments.
    bool restarts = true;
  };

  /// Parses the arguments (--config, --set, --lockstep, --verbose, --help) and joins the lab. On
  /// --help it prints the help, and fails with an error that says nothing and exits with done.
  static Expected<std::unique_ptr<Shell>> create(int argc, char** argv, const Options& options);
  /// The same for a tool that has arguments of its own: `arguments` are those of a service.
  static Expected<std::unique_ptr<Shell>> create(std::vector<std::string> arguments,
                                                 const Options& options);
  ~Shell();

  const Config& config() const;
  Status& status();
  bool lockstep() const;
  /// Now: process_now() live, of lab/clock in lockstep. What subscribers are handed is stamped by
  /// the same clock, wherever it comes from (common/clock).
  Time now() const;

  /// Who wrote a sample, as its status calls it; else, and always in lockstep, the identity of its
  /// participant.
  std::string writer_of(const dds::SampleInfo& info) const;
  /// What the writer of a sample is (dds::Participant::role_of).
  std::optional<dds::Role> role_of(const dds::SampleInfo& info) const;
  /// Peers that are here (dds::Participant::present).
  std::map<dds::GuidPrefix, dds::Peers::Presented> present() const;

  /// A function that publishes a sample on the topic, and one that disposes an instance by its key.
  /// A topic that cannot be joined makes run() fail, as it does for subscribe().
  template <class T>
  struct Output {
    std::function<void(const T&)> publish;
    std::function<void(const T&)> dispose;
  };
  template <class P>
  Output<typename P::type> publish(const dds::Topic<P>& topic);

  /// Calls on_sample for every sample of the topic; with info.gone only the key fields are set.
  template <class P>
  void subscribe(const dds::Topic<P>& topic,
                 std::function<void(const typename P::type&, const dds::SampleInfo&)> on_sample);

  /// Calls tick(now) every `period` live, and once each cycle in lockstep.
  void on_tick(Duration period, std::function<void(Time now)> tick);

  /// Runs `task` soon, in the thread of run(). Never used in lockstep, where all input comes by
  /// topic.
  void post(std::function<void()> task);

  /// Runs `task` at once, in the calling thread, when nothing else of the shell is running; drops
  /// it outside of run(). For devices whose frames must not wait for a change of threads.
  void exclusively(const std::function<void()>& task);

  /// As long as it moves a hand, it does not join anew for what can wait a minute.
  void busy_while(std::function<bool()> moves_hand);

  /// Ends run() with this exit code.
  void stop(Exit exit = exit_done);
  /// Whether run() will end at once, for who makes somebody wait before it.
  bool stopping() const;

  /// Until SIGTERM, SIGINT or stop(). Fails at once where a topic could not be joined.
  Expected<Exit> run();

 private:
  template <class T>
  class Listener;
  struct State;
  explicit Shell(std::unique_ptr<State> state);

  dds::Participant& participant();
  Input& add_input(std::string_view topic);
  /// Moves stamps from the writer's clock to ours.
  template <class T>
  void to_our_clock(dds::Sample<T>& sample) const;
  ClockSync::Ahead ahead(const dds::SampleInfo& info) const;
  void keep(std::unique_ptr<eprosima::fastdds::dds::DataReaderListener> listener);
  /// Called by the thread that received samples.
  void arrive(Input& input, std::vector<Arrival> arrivals);
  /// Remembers the first topic that could not be joined.
  void not_joined(const Error& error);
  void run_live();
  void run_in_lockstep();
  Time beat(Time now);
  std::function<void()> count_output(std::string_view topic);

  std::unique_ptr<State> state_;
};

template <class P>
Shell::Output<typename P::type> Shell::publish(const dds::Topic<P>& topic) {
  using T = typename P::type;
  auto made = participant().writer(topic);
  if (!made) {
    not_joined(made.error());
    return {[](const T&) {}, [](const T&) {}};
  }
  auto writer = std::make_shared<dds::Writer<T>>(std::move(*made));
  auto counted = count_output(topic.name);
  return {[this, writer, counted](const T& sample) {
            if (writer->write(sample))
              counted();
            else
              status().drop("sample not sent");
          },
          [writer, counted](const T& key) {
            if (writer->dispose(key)) counted();
          }};
}

/// Takes samples off the wire in the thread that received them.
template <class T>
class Shell::Listener : public eprosima::fastdds::dds::DataReaderListener {
 public:
  using OnSample = std::function<void(const T&, const dds::SampleInfo&)>;
  Listener(Shell& shell, Input& input, OnSample on_sample)
      : shell_(shell), input_(input), on_sample_(std::move(on_sample)) {}

  void on_data_available(eprosima::fastdds::dds::DataReader* raw) override {
    if (!reader_) reader_.emplace(raw);
    std::vector<Arrival> arrivals;
    for (dds::Sample<T>& sample : reader_->take()) {
      shell_.to_our_clock(sample);
      // A vanished instance carries no stamp of its own: it follows the topic's last sample.
      if (!sample.info.gone) stamp_ns_ = sample.data.stamp_ns();
      auto kept = std::make_shared<dds::Sample<T>>(std::move(sample));
      arrivals.push_back({stamp_ns_, [this, kept] { on_sample_(kept->data, kept->info); },
                          kept->info.participant, kept->info.instance});
    }
    shell_.arrive(input_, std::move(arrivals));
  }

 private:
  Shell& shell_;
  Input& input_;
  OnSample on_sample_;
  std::optional<dds::Reader<T>> reader_;
  std::int64_t stamp_ns_ = 0;
};

template <class T>
void Shell::to_our_clock(dds::Sample<T>& sample) const {
  const ClockSync::Ahead by = ahead(sample.info);
  sample.info.sent = moved(sample.info.sent, by.sent);
  if (by.stamps == Duration::zero()) return;
  sample.data.stamp_ns(to_ns(moved(from_ns(sample.data.stamp_ns()), by.stamps)));
  if constexpr (requires { sample.data.origin_ns(); })
    if (sample.data.origin_ns() != 0)
      sample.data.origin_ns(to_ns(moved(from_ns(sample.data.origin_ns()), by.stamps)));
}

template <class P>
void Shell::subscribe(
    const dds::Topic<P>& topic,
    std::function<void(const typename P::type&, const dds::SampleInfo&)> on_sample) {
  using T = typename P::type;
  auto listener = std::make_unique<Listener<T>>(*this, add_input(topic.name), std::move(on_sample));
  auto* raw = listener.get();
  keep(std::move(listener));
  if (auto made = participant().reader(topic, raw); !made) not_joined(made.error());
}

}  // namespace prehend::service
