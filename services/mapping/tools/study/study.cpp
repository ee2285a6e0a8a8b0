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

BenchmarkRequest benchmark_of(const Parts& parts, const StudyOptions& options) {
  BenchmarkRequest request;
  request.modes = {
      {BenchmarkMode::direct}, {BenchmarkMode::intelligent}, {BenchmarkMode::intelligent, true}};
  if (!options.modes.empty()) {
    request.modes.clear();
    for (const auto mode : options.modes)
      request.modes.insert(request.modes.end(), {{mode}, {mode, true}});
  } else if (!options.quick) {
    request.modes.push_back({BenchmarkMode::direct, true});
    for (const auto mode :
         {BenchmarkMode::cartesian, BenchmarkMode::combined, BenchmarkMode::retargeting})
      request.modes.insert(request.modes.end(), {{mode}, {mode, true}});
  }
  for (const std::string& name : options.hands) {
    const StudiedHand& studied = parts.hand(name);
    request.hands.push_back({studied.hand, *studied.model, studied.grasps, parts.bodies});
  }
  request.takes = options.trials > 0 ? options.trials : options.quick ? 24 : 270;
  request.seed = options.seed;
  request.quick = options.quick;
  request.take = options.take;
  return request;
}

std::vector<std::string> hands_of(const std::vector<Experiment>& experiments) {
  std::set<std::string> hands;
  for (const Experiment& experiment : experiments)
    hands.insert(experiment.hands.begin(), experiment.hands.end());
  return {hands.begin(), hands.end()};
}

}  // namespace prehend::mapping
