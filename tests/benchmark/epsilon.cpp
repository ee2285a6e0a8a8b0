// ε by Qhull's full hull against ε by the hull that grows only where it is nearest to the origin,
// on the same grasps in the same run. Ends with a table of the ratios; exit code 1 when the fast
// way is not at least 5 times as fast at 10 contacts and 20 times at 20 contacts.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <map>
#include <prehend/analysis/wrench_space.hpp>
#include <prehend/base/random.hpp>
#include <string>
#include <vector>

namespace {

using namespace prehend;
using namespace prehend::analysis;

constexpr int grasps = 20;

/// Contacts anywhere on a cup-sized ellipsoid, 8 edges each.
std::vector<Eigen::MatrixXd> wrenches(int contacts) {
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

template <class Measure>
void measure(benchmark::State& state, const Measure& epsilon) {
  const auto all = wrenches(static_cast<int>(state.range(0)));
  for (auto _ : state)
    for (const Eigen::MatrixXd& each : all) benchmark::DoNotOptimize(epsilon(each));
}

void full(benchmark::State& state) {
  measure(state, [](const Eigen::MatrixXd& w) { return wrench_quality(w); });
}

void fast(benchmark::State& state) {
  measure(state, [](const Eigen::MatrixXd& w) { return l1_resistance(w); });
}

BENCHMARK(full)->Arg(3)->Arg(5)->Arg(10)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK(fast)->Arg(3)->Arg(5)->Arg(10)->Arg(20)->Unit(benchmark::kMillisecond);

/// Prints as ever and remembers the time of each, for the ratios.
class Ratios : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) times[run.benchmark_name()] = run.GetAdjustedCPUTime() / grasps;
    ConsoleReporter::ReportRuns(runs);
  }
  std::map<std::string, double> times;  // ms a grasp
};

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  Ratios reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  const std::map<int, double> least{{3, 0}, {5, 0}, {10, 5}, {20, 20}};
  bool met = true;
  fmt::print("\n| contacts | full, ms | fast, ms | ratio | aim |\n|---|---|---|---|---|\n");
  for (const auto& [contacts, aim] : least) {
    const auto slow = reporter.times.find(fmt::format("full/{}", contacts));
    const auto quick = reporter.times.find(fmt::format("fast/{}", contacts));
    if (slow == reporter.times.end() || quick == reporter.times.end()) continue;
    const double ratio = slow->second / quick->second;
    met = met && ratio >= aim;
    fmt::print("| {} | {:.3g} | {:.3g} | {:.0f} | {} |\n", contacts, slow->second, quick->second,
               ratio, aim > 0 ? fmt::format("{:.0f}", aim) : "–");
  }
  return met ? 0 : 1;
}
