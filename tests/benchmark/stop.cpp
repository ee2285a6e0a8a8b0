// How long a hand still moves after a stop: a simulation in a process of its own, commands at 500
// Hz that let its base go around at 0.5 m/s, and a stop order at any time, once it has gone at that
// speed for 0.2 s. Measured is the time from right before the order is written until the last
// robot/state comes here that has moved from the one before: order there, world, state back. Beside
// it, in the same run, the speed that the base had at the order, and the one-way time of
// robot/state, from its source time stamp until it is handed over here. The floor is two of these
// and the speed divided by how hard the arm brakes.
//
// The states come at 500 Hz, so 2 ms is what can be told apart.
//
// With --flood another participant sends so many commands a second beside, which are refused.
//
//   benchmark_stop [--json] [--rounds N] [--brake M/S²] [--flood N/S]
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "common/base/paths.hpp"
#include "common/convert/convert.hpp"
#include "common/dds/participant.hpp"
#include "common/stage/process.hpp"
#include "tests/support/domains/domain_lease.hpp"

namespace prehend {
namespace {

using Eigen::Vector3d;
using std::chrono::milliseconds;

constexpr double commanded = 0.5;  // m/s

Time now() {
  return std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
}

template <class T>
T need(Expected<T> made) {
  if (made) return std::move(*made);
  std::cerr << made.error().message() << "\n";
  std::exit(3);
}

double quantile_ms(std::vector<double>& values, double q) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return 1e3 * values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1) + 0.5)];
}

/// Hears robot/state in the thread that receives it.
class States : public eprosima::fastdds::dds::DataReaderListener {
 public:
  void on_data_available(eprosima::fastdds::dds::DataReader* raw) override {
    const Time at = now();
    if (!reader_) reader_.emplace(raw);
    for (const auto& sample : reader_->take()) {
      if (sample.info.gone) continue;
      const std::scoped_lock lock(mutex_);
      const Vector3d p = convert::from_message(sample.data.X_WB().position());
      const double way = (p - p_).norm();
      if (way > 1e-6) moved_ = at;
      p_ = p;
      speed_ = way / (1e-9 * static_cast<double>(sample.data.stamp_ns() - stamp_ns_));
      stamp_ns_ = sample.data.stamp_ns();
      if (std::abs(speed_ - commanded) > 0.1 * commanded) unsteady_ = at;
      heard_ = at;
      if (hops_.size() < 1'000'000) hops_.push_back(to_seconds(at - sample.info.sent));
    }
  }
  Time moved() {
    const std::scoped_lock lock(mutex_);
    return moved_;
  }
  double speed() {
    const std::scoped_lock lock(mutex_);
    return speed_;
  }
  bool is_steady() {
    const std::scoped_lock lock(mutex_);
    return heard_ > unsteady_ + milliseconds(200);
  }
  Time heard() {
    const std::scoped_lock lock(mutex_);
    return heard_;
  }
  std::vector<double> hops() {
    const std::scoped_lock lock(mutex_);
    return hops_;
  }

 private:
  std::mutex mutex_;
  std::optional<dds::Reader<v1::HandState>> reader_;
  Vector3d p_ = Vector3d::Zero();
  Time moved_{}, heard_{}, unsteady_ = now();
  std::int64_t stamp_ns_ = 0;
  double speed_ = 0;
  std::vector<double> hops_;
};

/// Lets the base go around a circle of 10 cm.
void command(dds::Writer<v2::HandCommand>& writer, const std::atomic<bool>& ended) {
  v2::HandCommand message;
  message.hand("hand");
  message.model("barrett");
  message.dof({0, 0, 0, 0});
  const Time begin = now();
  for (std::uint64_t i = 0; !ended; ++i) {
    const double angle = commanded / 0.1 * to_seconds(now() - begin);
    message.sequence_number(i);
    message.stamp_ns(to_ns(now()));
    message.X_WB(convert::to_message(
        make_pose(Vector3d(0.1 * std::cos(angle), 0.1 * std::sin(angle) - 0.4, 0.6))));
    writer.write(message);
    std::this_thread::sleep_for(milliseconds(2));
  }
}

/// Somebody else's commands, as many a second as that, in bursts every 2 ms, until it is destroyed.
class Flood {
 public:
  Flood(int domain, const std::string& rig, int rate)
      : participant_(
            need(dds::Participant::create({.name = "flood", .domain = domain, .rig = rig}))),
        writer_(need(participant_.writer(dds::robot_command))),
        thread_([this, rate](const std::stop_token& stop) { send(stop, rate); }) {}

 private:
  void send(const std::stop_token& stop, int rate) {
    v2::HandCommand message;
    message.hand("hand");
    message.model("barrett");
    message.dof({0, 1, 1, 1});
    message.X_WB(convert::to_message(make_pose(Vector3d(0.5, 0, 0.6))));
    for (std::uint64_t i = 0; !stop.stop_requested();) {
      for (int burst = 0; burst < rate / 500; ++burst) {
        message.sequence_number(++i);
        message.stamp_ns(to_ns(now()));
        writer_.write(message);
      }
      std::this_thread::sleep_for(milliseconds(2));
    }
  }

  dds::Participant participant_;
  dds::Writer<v2::HandCommand> writer_;
  std::jthread thread_;  // last: joined before the rest goes
};

void wait_until(const std::function<bool()>& condition, const char* what) {
  for (int i = 0; i < 20'000; ++i) {
    if (condition()) return;
    std::this_thread::sleep_for(milliseconds(1));
  }
  std::cerr << "it does not come to that: " << what << "\n";
  std::exit(3);
}

void report(bool json, double brake, std::vector<double> stops, std::vector<double> speeds,
            std::vector<double> hops) {
  const double p50 = quantile_ms(stops, 0.5), p99 = quantile_ms(stops, 0.99),
               max = quantile_ms(stops, 1), hop50 = quantile_ms(hops, 0.5),
               hop99 = quantile_ms(hops, 0.99);
  const double speed = quantile_ms(speeds, 0.5) / 1e3;
  if (json)
    std::cout << nlohmann::ordered_json{{"rounds", stops.size()},
                                        {"stop_ms", {{"p50", p50}, {"p99", p99}, {"max", max}}},
                                        {"speed", speed},
                                        {"braking_ms", 1e3 * speed / brake},
                                        {"one_way_ms", {{"p50", hop50}, {"p99", hop99}}}}
                     .dump()
              << "\n";
  else
    fmt::print(
        "{} stops, order written → last state that moved: p50 {:.1f} ms, p99 {:.1f} ms, most "
        "{:.1f} ms\nof that, braking from {:.2f} m/s with {:.0f} m/s²: {:.1f} ms\nrobot/state, one "
        "way: "
        "p50 {:.2f} ms, p99 {:.2f} ms\n",
        stops.size(), p50, p99, max, speed, brake, 1e3 * speed / brake, hop50, hop99);
}

int run(bool json, int rounds, double brake, int flood_rate) {
  const test::DomainLease lease;
  const int domain = lease.domain();
  const std::string rig = fmt::format("stop-{}", ::getpid());
  States states;
  auto participant =
      need(dds::Participant::create({.name = "operator", .domain = domain, .rig = rig}));
  auto commands = need(participant.writer(dds::robot_command));
  auto orders = need(participant.writer(dds::operator_command));
  (void)need(participant.reader(dds::robot_state, &states));
  auto simulation = need(stage::Process::start(
      {.command = {(program_directory() / "prehend-simulation").string(), "--set", "lab.rig=" + rig,
                   "--set", fmt::format("lab.domain={}", domain), "--set",
                   "simulation.state_rate=500", "--set",
                   fmt::format("simulation.brake={:.3f}", brake)},
       .log = std::filesystem::temp_directory_path() / (rig + ".log")}));
  const auto matched = [](auto& writer) {
    eprosima::fastdds::dds::PublicationMatchedStatus status;
    writer.raw().get_publication_matched_status(status);
    return status.current_count > 0;
  };
  wait_until([&] { return matched(commands) && matched(orders); }, "a simulation");
  std::atomic<bool> ended = false;
  std::thread stream([&] { command(commands, ended); });
  std::optional<Flood> flood;
  if (flood_rate > 0) {
    wait_until([&] { return states.is_steady(); }, "a steady motion");
    flood.emplace(domain, rig, flood_rate);
  }
  auto order = [&, number = 0](v1::OperatorAction action) mutable {
    v1::OperatorCommand message;
    message.id(fmt::format("order-{}", ++number).c_str());
    message.action(action);
    message.target("gate");
    message.argument("benchmark");
    message.stamp_ns(to_ns(now()));
    orders.write(message);
  };
  std::vector<double> stops, speeds;
  std::mt19937 random(1);
  for (int round = 0; round < rounds; ++round) {
    order(v1::ACTION_RELEASE);
    const Time released = now();
    wait_until([&] { return now() > released + milliseconds(300) && states.is_steady(); },
               "a steady motion");
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 20'000));
    speeds.push_back(states.speed());
    const Time stopped = now();
    order(v1::ACTION_STOP);
    wait_until([&] { return states.heard() > states.moved() + milliseconds(200); }, "a stop");
    stops.push_back(std::max(0.0, to_seconds(states.moved() - stopped)));
  }
  ended = true;
  stream.join();
  flood.reset();
  simulation.stop(std::chrono::seconds(5));
  std::filesystem::remove(std::filesystem::temp_directory_path() / (rig + ".log"));
  report(json, brake, stops, speeds, states.hops());
  return 0;
}

}  // namespace
}  // namespace prehend

int main(int argc, char** argv) {
  bool json = false;
  int rounds = 100;
  double brake = 20;
  int flood_rate = 0;
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--json") {
      json = true;
    } else if (argument == "--rounds" && i + 1 < argc) {
      rounds = std::max(1, std::atoi(argv[++i]));
    } else if (argument == "--brake" && i + 1 < argc) {
      brake = std::max(0.1, std::atof(argv[++i]));
    } else if (argument == "--flood" && i + 1 < argc) {
      flood_rate = std::max(0, std::atoi(argv[++i]));
    } else {
      std::cerr << "benchmark_stop [--json] [--rounds N] [--brake M/S²] [--flood N/S]\n";
      return 2;
    }
  }
  return prehend::run(json, rounds, brake, flood_rate);
}
