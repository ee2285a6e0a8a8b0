// ε by Qhull's full hull against ε by the hull that grows only where it is nearest to the origin,
// on the same grasps in the same run. Ends with a table of the ratios; exit code 1 when the fast
// way is not at least 5 times as fast at 10 contacts and 20 times at 20 contacts.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "common/analysis/wrench_space.hpp"
#include "common/base/random.hpp"

namespace {

using namespace prehend;
using namespace prehend::analysis;

constexpr int grasps = 20;

/// Equal contacts around a cylinder, whose edges follow its axis.
std::vector<Eigen::MatrixXd> ring(int contacts) {
  std::vector<Contact> touches;
  for (int i = 0; i < contacts; ++i) {
    const double a = 2 * std::numbers::pi * i / contacts;
    const Eigen::Vector3d out(std::cos(a), std::sin(a), 0);
    Contact touch{"", 0.03 * out, -out, 0.6, 1, 0};
    touch.tangent_O = Eigen::Vector3d::UnitZ();
    touches.push_back(touch);
  }
  return {contact_wrenches(touches, 0.06)};
}

/// Contacts anywhere on a cup-sized ellipsoid, 8 edges each.
std::vector<Eigen::MatrixXd> anywhere(int contacts) {
  Random random(static_cast<std::uint64_t>(contacts));
  const Eigen::Vector3d radii(0.03, 0.04, 0.06);
  std::vector<Eigen::MatrixXd> made;
  for (int grasp = 0; grasp < grasps; ++grasp) {
    std::vector<Contact> touches;
    for (int i = 0; i < contacts; ++i) {
      const Eigen::Vector3d out = random.normal3(1).normalized();
      touches.push_back({"", radii.cwiseProduct(out), -out.cwiseQuotient(radii).normalized(),
                         random.uniform(0.3, 1.0), 1, 0});
    }
    made.push_back(contact_wrenches(touches, 0.06));
  }
  return made;
}

using Grasps = std::vector<Eigen::MatrixXd> (*)(int contacts);

void full(benchmark::State& state, Grasps make) {
  const auto all = make(static_cast<int>(state.range(0)));
  for (auto _ : state)
    for (const Eigen::MatrixXd& each : all) benchmark::DoNotOptimize(wrench_quality(each));
}

void fast(benchmark::State& state, Grasps make) {
  const auto all = make(static_cast<int>(state.range(0)));
  for (auto _ : state)
    for (const Eigen::MatrixXd& each : all) benchmark::DoNotOptimize(l1_resistance(each));
}

void counts(benchmark::internal::Benchmark* benchmark) {
  benchmark->Arg(3)->Arg(5)->Arg(10)->Arg(20)->Unit(benchmark::kMillisecond);
}

BENCHMARK_CAPTURE(full, anywhere, anywhere)->Apply(counts);
BENCHMARK_CAPTURE(fast, anywhere, anywhere)->Apply(counts);
BENCHMARK_CAPTURE(full, ring, ring)->Apply(counts);
BENCHMARK_CAPTURE(fast, ring, ring)->Apply(counts);

/// Prints as ever and remembers the time of each, for the ratios.
class Ratios : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) times[run.benchmark_name()] = run.GetAdjustedCPUTime();
    ConsoleReporter::ReportRuns(runs);
  }
  std::map<std::string, double> times;  // ms
};

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  Ratios reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  const std::map<int, double> least{{3, 0}, {5, 0}, {10, 5}, {20, 20}};
  bool met = true;
  fmt::print(
      "\n| contacts | where | full, ms | fast, ms | ratio | aim |\n|---|---|---|---|---|---|\n");
  for (const std::string where : {"anywhere", "ring"})
    for (const auto& [contacts, aim] : least) {
      const auto slow = reporter.times.find(fmt::format("full/{}/{}", where, contacts));
      const auto quick = reporter.times.find(fmt::format("fast/{}/{}", where, contacts));
      if (slow == reporter.times.end() || quick == reporter.times.end()) continue;
      const double ratio = slow->second / quick->second;
      const bool has_aim = where == "anywhere" && aim > 0;
      met = met && (!has_aim || ratio >= aim);
      const int share = where == "anywhere" ? grasps : 1;
      fmt::print("| {} | {} | {:.3g} | {:.3g} | {:.1f} | {} |\n", contacts, where,
                 slow->second / share, quick->second / share, ratio,
                 has_aim ? fmt::format("{:.0f}", aim) : "–");
    }
  return met ? 0 : 1;
}
