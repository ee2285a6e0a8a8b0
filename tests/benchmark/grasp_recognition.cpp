// One posture through the recognition of grasps, all classes: latency of each as p50 and p99. Aim:
// p99 below 50 µs. Recognisers are trained on made takes of 18 people and four kinds, as many as in
// the real ones; numbers take as long whatever they are. GRASP_MODEL names a trained model instead.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <stdexcept>
#include <vector>

#include "services/demonstration/core/recognition/recogniser.hpp"
#include "services/demonstration/files/recogniser_file.hpp"
#include "services/demonstration/tools/training/trainer.hpp"
#include "tests/support/takes/made_takes.hpp"

namespace {

using namespace prehend;
using namespace prehend::demonstration;

const std::vector<Take>& takes() {
  static const auto made =
      test::made_takes({.people = 18, .classes = {"bottle", "cup", "knife", "pen"}});
  return made;
}

std::vector<Recogniser> recognisers() {
  std::vector<Recogniser> made;
  if (const char* file = std::getenv("GRASP_MODEL")) {
    const auto read = load_recognisers(file);
    if (!read) throw std::runtime_error(read.error().message());
    for (const TaskRecogniser& one : *read)
      if (one.task == read->front().task) made.push_back(one.recogniser);
    return made;
  }
  std::vector<const Take*> shown;
  for (const Take& take : takes()) shown.push_back(&take);
  return *train_recognisers(shown, {methods.begin(), methods.end()}, {});
}

/// A grasp after the other, sample by sample.
void samples(benchmark::State& state, const Recogniser& recogniser) {
  std::vector<double> took;
  std::size_t take = 0, sample = 0;
  RecogniserStream stream(recogniser);
  for (auto _ : state) {
    const auto& samples = takes()[take].samples;
    const auto begin = std::chrono::steady_clock::now();
    const Eigen::VectorXd* shares = &stream.add(samples[sample]);
    benchmark::DoNotOptimize(shares);
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
    took.push_back(elapsed.count());
    state.SetIterationTime(elapsed.count());
    if (++sample < samples.size()) continue;
    sample = 0;
    take = (take + 1) % takes().size();
    stream = RecogniserStream(recogniser);
  }
  std::sort(took.begin(), took.end());
  state.counters["p50_us"] = 1e6 * took[took.size() / 2];
  state.counters["p99_us"] = 1e6 * took[took.size() * 99 / 100];
}

}  // namespace

int main(int argc, char** argv) {
  const auto all = recognisers();
  for (const Recogniser& recogniser : all)
    benchmark::RegisterBenchmark(std::string(to_string(recogniser.method())).c_str(),
                                 [&](benchmark::State& state) { samples(state, recogniser); })
        ->UseManualTime();
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
