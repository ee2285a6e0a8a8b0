#include "services/mapping/tools/study/study.hpp"

#include <set>

namespace prehend::mapping {

std::vector<Studied> study(const Parts& parts, const std::vector<Experiment>& experiments,
                           const StudyOptions& options, const grasping::ForEach& for_each) {
  struct Piece {
    std::size_t experiment, repetition;
  };
  std::vector<Piece> pieces;
  std::vector<Studied> studied;
  for (std::size_t e = 0; e < experiments.size(); ++e) {
    const Experiment& experiment = experiments[e];
    const std::size_t count = options.quick ? experiment.quick : experiment.full;
    for (std::size_t i = 0; i < count; ++i) pieces.push_back({e, i});
    studied.push_back({&experiment,
                       {experiment.columns,
                        Eigen::MatrixXd(static_cast<Eigen::Index>(count),
                                        static_cast<Eigen::Index>(experiment.columns.size()))},
                       {}});
  }
  for_each(pieces.size(), [&](std::size_t i) {
    const auto [e, index] = pieces[i];
    const Repetition repetition{index, repetition_seed(options.seed, experiments[e].figure, index)};
    studied[e].table.values.row(static_cast<Eigen::Index>(index)) =
        experiments[e].repeat(parts, repetition);
  });
  for (Studied& one : studied) one.outcome = one.experiment->judge(one.table);
  return studied;
}

Expected<std::vector<TrialResult>> benchmark(const Parts& parts, const StudyOptions& options,
                                             const grasping::ForEach& for_each,
                                             const std::function<void(double)>& progress) {
  std::vector<BenchmarkedMode> modes{
      {BenchmarkMode::direct}, {BenchmarkMode::intelligent}, {BenchmarkMode::intelligent, true}};
  if (!options.modes.empty()) {
    modes.clear();
    for (const auto mode : options.modes) modes.insert(modes.end(), {{mode}, {mode, true}});
  } else if (!options.quick) {
    modes.push_back({BenchmarkMode::direct, true});
    for (const auto mode :
         {BenchmarkMode::cartesian, BenchmarkMode::combined, BenchmarkMode::retargeting})
      modes.insert(modes.end(), {{mode}, {mode, true}});
  }

  std::vector<TrialResult> all;
  double done = 0;
  const double pieces = static_cast<double>(options.hands.size() * modes.size());
  for (const std::string& name : options.hands) {
    const StudiedHand& studied = parts.hand(name);
    const BenchmarkedHand hand{studied.hand, *studied.model, studied.grasps, parts.catalogue};
    for (const BenchmarkedMode& mode : modes) {
      GraspBenchmarkOptions asked;
      asked.modes = {mode};
      asked.trials = options.trials > 0 ? options.trials : options.quick ? 24 : 270;
      asked.seed += options.seed;
      asked.take = options.take;
      auto trials = run_grasp_benchmark(hand, asked, for_each,
                                        [&](double share) { progress((done + share) / pieces); });
      progress(++done / pieces);
      if (trials)
        all.insert(all.end(), trials->begin(), trials->end());
      else if (mode.mode == BenchmarkMode::direct || mode.mode == BenchmarkMode::intelligent)
        return trials;
      // Other modes are not for every hand.
    }
  }
  return all;
}

std::vector<std::string> hands_of(const std::vector<Experiment>& experiments) {
  std::set<std::string> hands;
  for (const Experiment& experiment : experiments)
    hands.insert(experiment.hands.begin(), experiment.hands.end());
  return {hands.begin(), hands.end()};
}

}  // namespace prehend::mapping
