#pragma once

#include <functional>
#include <memory>
#include <prehend/dds/participant.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "config.hpp"
#include "status.hpp"

namespace prehend::service {

/// The shell of every process: arguments, configuration, life cycle, input, time, status.
///
/// Use: create(), then publish() and subscribe(), on_tick(), run(). Everything that is given to the
/// shell is called in the thread of run(), one call at a time; only post() and status() may be used
/// from other threads.
///
/// Live, inputs are handed over as they come, and the tick follows the system clock. In lockstep
/// (lab.lockstep = true, or --lockstep) inputs are handed over in the order (stamp, topic,
/// sequence) of what the clock's cycle says has been published, then comes one tick, then
/// lab/progress is answered; nothing then depends on when messages arrive.
class Shell {
 public:
  struct Options {
    std::string name;         // of the service: glove, mapping, ...
    std::string description;  // first line of --help
  };

  /// Parses the arguments (--config, --set, --lockstep, --verbose, --help) and joins the lab. On
  /// --help or an error it prints what there is to say and returns nothing; exit_code tells.
  static std::unique_ptr<Shell> create(int argc, char** argv, const Options& options,
                                       int& exit_code);
  ~Shell();

  const Config& config() const;
  Status& status();
  bool lockstep() const;
  /// Now: of the system live, of lab/clock in lockstep.
  Time now() const;

  /// A function that publishes a sample on the topic, and one that disposes an instance by its key.
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

  /// Runs `task` soon in the thread of run(). For threads that block on a device; never used in
  /// lockstep, where all input comes by topic.
  void post(std::function<void()> task);

  /// Ends run() with this exit code: 3 where the environment is broken.
  void stop(int exit_code = 0);

  /// Until SIGTERM, SIGINT or stop(). Returns the exit code.
  int run();

 private:
  struct Input {
    std::string_view topic;
    eprosima::fastdds::dds::DataReader* reader = nullptr;
    /// What has arrived, in order; the stamp to order it among topics, and how to hand it over.
    struct Arrival {
      std::int64_t stamp_ns = 0;
      std::function<void()> deliver;
      std::uint64_t index = 0;  // lockstep: counts the topic's samples as they arrive
    };
    std::function<std::vector<Arrival>()> take;
    std::vector<Arrival> waiting;  // lockstep: arrived, not yet due
    std::uint64_t received = 0;
  };
  struct State;
  explicit Shell(std::unique_ptr<State> state);

  dds::Participant& participant();
  void add_input(Input input);
  [[noreturn]] static void refuse(const Error& error);
  std::function<void()> count_output(std::string_view topic);

  std::unique_ptr<State> state_;
};

template <class P>
Shell::Output<typename P::type> Shell::publish(const dds::Topic<P>& topic) {
  using T = typename P::type;
  auto made = participant().writer(topic);
  if (!made) refuse(made.error());
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

template <class P>
void Shell::subscribe(
    const dds::Topic<P>& topic,
    std::function<void(const typename P::type&, const dds::SampleInfo&)> on_sample) {
  using T = typename P::type;
  auto made = participant().reader(topic);
  if (!made) refuse(made.error());
  auto reader = std::make_shared<dds::Reader<T>>(std::move(*made));
  Input input;
  input.topic = topic.name;
  input.reader = &reader->raw();
  input.take = [reader, on_sample, stamp = std::int64_t{0}]() mutable {
    std::vector<typename Input::Arrival> arrivals;
    for (dds::Sample<T>& sample : reader->take()) {
      // A vanished instance carries no stamp of its own: it follows the topic's last sample.
      if (!sample.info.gone) stamp = sample.data.stamp_ns();
      auto kept = std::make_shared<dds::Sample<T>>(std::move(sample));
      arrivals.push_back({stamp, [kept, on_sample] { on_sample(kept->data, kept->info); }});
    }
    return arrivals;
  };
  add_input(std::move(input));
}

}  // namespace prehend::service
