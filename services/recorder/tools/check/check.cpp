#include "services/recorder/tools/check/check.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <set>
#include <tuple>

#include "common/base/file_text.hpp"
#include "common/dds/topics.hpp"
#include "common/service/membership.hpp"
#include "common/stage/conductor.hpp"
#include "common/stage/lab.hpp"
#include "services/recorder/service/describe.hpp"
#include "services/recorder/service/recording_file.hpp"
#include "services/recorder/tools/check/recorded_lab.hpp"

namespace prehend::recorder {
namespace {

using Kind = dds::RawSample::Kind;
using Topics = std::set<std::string>;

/// A service that can be run over a recording, with the topics it is fed and those it answers.
struct Service {
  std::string name;
  Topics reads, writes;
};
std::vector<Service> services_of_table() {
  std::vector<Service> services;
  for (const dds::Role role : checkable) {
    Service service{std::string(dds::name_of(role)), {}, {}};
    for (const dds::TopicInfo& topic : dds::topic_table) {
      if (dds::is_input(role, topic)) service.reads.emplace(topic.name);
      if (dds::is_output(role, topic)) service.writes.emplace(topic.name);
    }
    services.push_back(std::move(service));
  }
  return services;
}
const std::vector<Service>& services() {
  static const std::vector<Service> all = services_of_table();
  return all;
}

/// What nobody reads or writes (a recording holds more) makes no cycle.
bool is_of_services(const std::string& topic) {
  return std::any_of(services().begin(), services().end(), [&](const Service& service) {
    return service.reads.contains(topic) || service.writes.contains(topic);
  });
}

bool is_answer(const std::string& topic) {
  return std::any_of(services().begin(), services().end(),
                     [&](const Service& service) { return service.writes.contains(topic); });
}

constexpr Duration tick = std::chrono::milliseconds(10);
constexpr std::chrono::milliseconds patience{30'000};
constexpr Duration longest = std::chrono::hours(24);  // all that is fed is held in memory
constexpr int max_cycles = 1000;  // at one time, before services are said not to come to rest

std::int64_t ns_of(const Played& played) {
  return to_ns(played.log_time);
}

/// Answers on one topic, as they come.
class Answers {
 public:
  void add(dds::RawSample&& sample) {
    {
      const std::scoped_lock lock(mutex_);
      samples_.push_back(std::move(sample));
    }
    news_.notify_all();
  }
  /// Gives all up to the count this log time.
  bool stamp(std::uint64_t count, Time log_time) {
    std::unique_lock lock(mutex_);
    if (!news_.wait_for(lock, patience, [&] { return samples_.size() >= count; })) return false;
    for (; stamped_ < count; ++stamped_) samples_[stamped_].received = log_time;
    return true;
  }
  /// In order of their log times; equal ones of several services by what they are about.
  std::vector<dds::RawSample> take() {
    std::ranges::stable_sort(samples_, {}, [](const dds::RawSample& sample) {
      return std::tuple(sample.received, sample.instance);
    });
    return std::move(samples_);
  }

 private:
  std::mutex mutex_;
  std::condition_variable news_;
  std::vector<dds::RawSample> samples_;
  std::uint64_t stamped_ = 0;
};

recording::ComparedSample compared(const std::string& topic,
                                   const recording::types::Structure* type,
                                   const dds::RawSample& sample) {
  recording::ComparedSample result{.topic = topic, .type = type, .payload = sample.payload};
  if (sample.kind != Kind::data)
    result.end = (sample.kind == Kind::disposed ? "disposed " : "unregistered ") +
                 recording::to_hex(sample.instance);
  return result;
}

/// One run of the services over a recording.
class Run {
 public:
  Run(const CheckOptions& options, std::vector<Played> played, RecordedLab lab,
      std::vector<RecordedProcess> processes)
      : options_(options),
        played_(std::move(played)),
        recorded_(std::move(lab)),
        recorded_processes_(std::move(processes)) {}

  Expected<void> choose_services() {
    Topics recorded;
    for (const Played& one : played_) recorded.insert(one.stream->topic.name);
    for (const Service& service : services()) {
      const bool asked = std::find(options_.services.begin(), options_.services.end(),
                                   service.name) != options_.services.end();
      const bool answered =
          std::any_of(service.writes.begin(), service.writes.end(),
                      [&](const std::string& topic) { return recorded.contains(topic); });
      if (options_.services.empty() ? !answered : !asked) continue;
      const std::size_t before = processes_.size();
      for (const RecordedProcess& process : recorded_processes_)
        if (process.service == service.name) processes_.push_back(process);
      if (processes_.size() == before) {
        // It did not run, where others told that they did: another wrote these.
        if (!asked && !recorded_processes_.empty()) continue;
        processes_.push_back({service.name, {}});
      }
      reads_.insert(service.reads.begin(), service.reads.end());
      writes_.insert(service.writes.begin(), service.writes.end());
    }
    if (processes_.empty())
      return fail("holds nothing that a service answered", options_.file.string(),
                  "record again while a mapping or a simulation runs in the lab");
    return {};
  }
  bool feeds(const std::string& topic) const {
    return reads_.contains(topic) && !writes_.contains(topic);
  }
  bool asks(const std::string& topic) const { return writes_.contains(topic); }
  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const RecordedProcess& process : processes_) names.push_back(process.service);
    return names;
  }

  Expected<void> start() {
    const auto config = options_.lab.load();
    if (!config) return tl::unexpected(config.error());
    const std::string rig = fmt::format(
        "check-{}-{:x}", ::getpid(), std::chrono::system_clock::now().time_since_epoch().count());
    dds::ParticipantOptions membership = service::membership(*config, "check", "replayer");
    membership.rig = rig;
    membership.lockstep = true;
    const std::vector<std::string> ours{"glove.device=topic", "recognition.source=topic",
                                        "lab.lockstep=true", "lab.rig=" + rig,
                                        fmt::format("lab.domain={}", membership.domain)};
    lab_.emplace(options_.lab.file(), std::vector<std::string>(), options_.log_folder);
    if (const auto started = start_services(ours); !started) return started;

    auto participant = dds::Participant::create(membership);
    if (!participant) return tl::unexpected(participant.error());
    participant_.emplace(std::move(*participant));
    auto conductor = stage::Conductor::create(*participant_, names());
    if (!conductor) return tl::unexpected(conductor.error());
    conductor_.emplace(std::move(*conductor));
    for (const std::string& topic : writes_) {
      Answers* answers = (answers_[topic] = std::make_unique<Answers>()).get();
      auto reader = dds::RawReader::create(
          *participant_, known(topic),
          [answers](dds::RawSample&& sample) { answers->add(std::move(sample)); });
      if (!reader) return tl::unexpected(reader.error());
      readers_.push_back(std::move(*reader));
    }
    for (const Played& one : played_) {
      const dds::RawTopic& topic = one.stream->topic;
      if (!feeds(topic.name) || writers_.contains(topic.name)) continue;
      auto writer = dds::RawWriter::create(*participant_, topic);
      if (!writer) return tl::unexpected(writer.error());
      writers_.emplace(topic.name, std::move(*writer));
    }
    return {};
  }

  Expected<void> play(const std::function<void(double)>& progress) {
    // All together, services read what others have said just before; alone, a service reads that
    // from the recording, in cycles of the same times.
    std::set<std::int64_t> times;
    // Counted from what stays as it is when the answers are renewed.
    const auto begin = std::ranges::find_if_not(
        played_, [](const Played& one) { return is_answer(one.stream->topic.name); });
    const std::int64_t first = ns_of(begin != played_.end() ? *begin : played_.front()),
                       last = ns_of(played_.back());
    for (std::int64_t time = first; time <= last; time += tick.count()) times.insert(time);
    const bool alone = !options_.services.empty();
    for (const Played& one : played_)
      if (alone ? is_of_services(one.stream->topic.name) : feeds(one.stream->topic.name))
        times.insert(ns_of(one));
    std::size_t next = 0;
    std::int64_t done = 0;
    for (const std::int64_t time : times) {
      for (; next < played_.size() && ns_of(played_[next]) <= time; ++next) {
        const Played& one = played_[next];
        if (!feeds(one.stream->topic.name)) continue;
        if (!writers_.find(one.stream->topic.name)->second.write(one.sample, one.sample.sent))
          return fail("cannot be published", one.stream->topic.name);
        conductor_->published(one.stream->topic.name);
      }
      for (int cycle = 0;; ++cycle) {
        if (cycle == max_cycles)
          return fail("the services do not come to rest", "lockstep", "who goes on publishing?");
        done = std::max(done + 1, time + cycle);
        const auto before = conductor_->totals();
        const auto dead = [&] { return lab_->casualty(); };
        if (const auto stepped = conductor_->step(from_ns(done), patience, dead); !stepped)
          return stepped;
        const auto now = conductor_->totals();
        if (const auto stamped = stamp(now, from_ns(done + 1)); !stamped) return stamped;
        if (alone || now == before) break;
      }
      progress(static_cast<double>(time - first) / static_cast<double>(last - first + 1));
    }
    return {};
  }

  std::map<std::string, std::vector<dds::RawSample>> answers() {
    readers_.clear();
    std::map<std::string, std::vector<dds::RawSample>> all;
    for (auto& [topic, answers] : answers_) all[topic] = answers->take();
    lab_->stop();
    return all;
  }

  const std::vector<Played>& played() const { return played_; }

 private:
  /// Each with what was recorded of it, under what the user sets and what we need.
  Expected<void> start_services(const std::vector<std::string>& ours) {
    std::vector<std::string> files;
    for (const auto& [key, name, text] :
         {std::tuple("lab.scene", "scene.toml", &recorded_.scene),
          std::tuple("lab.catalogue", "catalogue.toml", &recorded_.catalogue)}) {
      if (text->empty()) continue;
      const auto file = options_.log_folder / name;
      if (auto written = write_file(file, *text); !written) return written;
      files.push_back(fmt::format("{}={}", key, file.string()));
    }
    std::map<std::string, int> started;  // of each service
    for (const RecordedProcess& process : processes_) {
      std::vector<std::string> sets;
      for (const Settings* settings : {&std::as_const(recorded_.configuration), &process.settings})
        for (const auto& [key, value] : *settings)
          if (!is_of_the_machine(key)) sets.push_back(key + "=" + value);
      std::vector<std::string> arguments{"--config", options_.lab.file()};
      for (const auto& more : {sets, files, options_.lab.overrides(), ours})
        for (const std::string& set : more) arguments.insert(arguments.end(), {"--set", set});
      const int number = ++started[process.service];
      const auto done =
          lab_->start(number == 1 ? process.service : fmt::format("{} {}", process.service, number),
                      "prehend-" + process.service, arguments);
      if (!done) return done;
    }
    return {};
  }

  /// As it was recorded, or as our contract has it.
  dds::RawTopic known(const std::string& name) const {
    for (const Played& one : played_)
      if (one.stream->topic.name == name) return one.stream->topic;
    return dds::raw_topic(*dds::find_topic(name));
  }

  Expected<void> stamp(const std::map<std::string, std::uint64_t>& totals, Time log_time) {
    for (auto& [topic, answers] : answers_)
      if (const auto count = totals.find(topic); count != totals.end())
        if (!answers->stamp(count->second, log_time))
          return fail("answers were said to be published and did not come", topic);
    return {};
  }

  const CheckOptions& options_;
  std::vector<Played> played_;
  RecordedLab recorded_;
  std::vector<RecordedProcess> recorded_processes_, processes_;  // all, and those that are run
  Topics reads_, writes_;
  std::optional<stage::Lab> lab_;
  std::map<std::string, std::unique_ptr<Answers>> answers_;
  std::optional<dds::Participant> participant_;
  std::optional<stage::Conductor> conductor_;
  std::vector<std::unique_ptr<dds::RawReader>> readers_;
  std::map<std::string, dds::RawWriter> writers_;
};

}  // namespace

Expected<Checked> check(const CheckOptions& options, const recording::types::Library& types,
                        const recording::ToleranceTable& tolerances,
                        const std::function<void(double)>& progress) {
  auto tape = Tape::open({options.file}, [](const std::string&) { return true; });
  if (!tape) return tl::unexpected(tape.error());
  if (tape->end() - tape->start() > longest)
    return fail("is too long to be checked", options.file.string(),
                "prehend recording cut takes a part");
  std::vector<Played> played;
  while (auto one = tape->next()) played.push_back(std::move(*one));
  if (!tape->damage().empty()) return tl::unexpected(tape->damage().front());

  const auto began = std::chrono::steady_clock::now();
  auto processes = recorded_processes(played, types);
  Run run(options, std::move(played), recorded_lab(tape->file(0)), std::move(processes));
  if (const auto chosen = run.choose_services(); !chosen) return tl::unexpected(chosen.error());
  if (const auto started = run.start(); !started) return tl::unexpected(started.error());
  if (const auto done = run.play(progress); !done) return tl::unexpected(done.error());
  Checked result;
  result.services = run.names();
  result.answers = run.answers();
  result.recorded_s = to_seconds(tape->end() - tape->start());
  result.elapsed_s = to_seconds(std::chrono::steady_clock::now() - began);

  recording::Comparison comparison(tolerances);
  const auto type_of = [&](const std::string& topic) {
    for (const Played& one : run.played())
      if (one.stream->topic.name == topic) return types.find(one.stream->topic.type);
    return static_cast<const recording::types::Structure*>(nullptr);
  };
  for (const Played& one : run.played())
    if (run.asks(one.stream->topic.name))
      comparison.add(
          recording::Side::expected,
          compared(one.stream->topic.name, types.find(one.stream->topic.type), one.sample));
  for (const auto& [topic, samples] : result.answers)
    for (const dds::RawSample& sample : samples)
      comparison.add(recording::Side::actual, compared(topic, type_of(topic), sample));
  result.report = comparison.finish();
  // No sample on either side is no sameness.
  if (result.report.topics.empty())
    return fail(fmt::format("holds no answer of {}, and nothing was answered now",
                            fmt::join(result.services, ", ")),
                options.file.string(), "choose other services: prehend recording info FILE");
  return result;
}

Expected<void> update(const std::filesystem::path& file, const Checked& checked) {
  auto tape = Tape::open({file}, [](const std::string&) { return true; });
  if (!tape) return tl::unexpected(tape.error());
  auto describe = describe_types("ros2msg");
  if (!describe) return tl::unexpected(describe.error());
  const RecordedLab lab = recorded_lab(tape->file(0));
  const Heading heading{lab.configuration, lab.scene, std::move(*describe), lab.catalogue};

  std::map<const recording::Stream*, Source> sources;
  std::map<std::string, const recording::Stream*> first;  // of each topic
  for (const recording::Stream* stream : tape->streams()) {
    sources[stream] = {stream->topic, stream->rig};
    first.try_emplace(stream->topic.name, stream);
  }
  std::map<std::string, Source> new_sources;
  struct Entry {
    const Source* source;
    dds::RawSample sample;
  };
  std::vector<Entry> entries;
  while (auto one = tape->next())
    if (!checked.answers.contains(one->stream->topic.name))
      entries.push_back({&sources[one->stream], std::move(one->sample)});
  for (const auto& [topic, samples] : checked.answers) {
    const auto known = first.find(topic);
    Source& source = new_sources[topic];
    source = known != first.end() ? sources[known->second]
                                  : Source{dds::raw_topic(*dds::find_topic(topic)), ""};
    for (dds::RawSample sample : samples) {
      sample.writer = known != first.end() ? known->second->writer : dds::Guid{};
      sample.sent = sample.received;  // nothing of this day and machine
      entries.push_back({&source, std::move(sample)});
    }
  }
  std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return a.sample.received < b.sample.received;
  });

  const std::filesystem::path beside = file.string() + ".new";
  auto written = RecordingFile::create(beside, heading, recording::mcap::Compression::zstd);
  if (!written) return tl::unexpected(written.error());
  for (const Entry& entry : entries)
    if (const auto done = written->write(*entry.source, entry.sample, entry.sample.received); !done)
      return done;
  if (const auto done = written->close(); !done) return done;
  std::error_code code;
  std::filesystem::rename(beside, file, code);
  if (code) return fail(code.message(), file.string());
  return {};
}

}  // namespace prehend::recorder
