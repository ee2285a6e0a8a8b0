#include <Eigen/Geometry>
#include <array>

#include "common/base/random.hpp"
#include "common/learning/training.hpp"
#include "services/demonstration/tools/training/material.hpp"

namespace prehend::demonstration {

namespace {

constexpr std::array shares{0.5, 1.0};  // of a grasp: networks learn its beginnings, too
constexpr double wanted_answer = 0.9;   // of a network, for the class that it is

/// The same grasp by somebody who stands a little elsewhere and has another hand.
Take varied(Take take, const TrainerOptions& options, Random& random) {
  const Eigen::AngleAxisd turn(random.uniform(-options.max_turn, options.max_turn),
                               Eigen::Vector3d::UnitZ());
  const double stretch = 1 + random.uniform(-options.max_stretch, options.max_stretch);
  for (HandSample& sample : take.samples) {
    for (Eigen::Vector3d& tip : sample.p_thumb_tip_W) tip = stretch * (turn * tip);
    for (Eigen::Vector3d& tip : sample.p_HF) tip *= stretch;
    sample.scale *= stretch;
  }
  return take;
}

/// Summaries of beginnings of grasps.
struct Summaries {
  std::vector<Eigen::VectorXd> columns;
  std::vector<std::size_t> takes;  // of the columns
};

void add_beginnings(Summaries& summaries, const Take& take, std::size_t number, Inputs inputs) {
  Summary summary(inputs);
  std::size_t share = 0;
  const auto reached = [&](double done) {
    return share < shares.size() && done > shares[share] - 1e-9;
  };
  for (std::size_t i = 0; i < take.samples.size(); ++i) {
    const Eigen::VectorXd now = summary.add(take.samples[i]);
    const double done = static_cast<double>(i + 1) / static_cast<double>(take.samples.size());
    if (!reached(done)) continue;
    while (reached(done)) ++share;
    summaries.columns.push_back(now);
    summaries.takes.push_back(number);
  }
}

Eigen::MatrixXd to_matrix(const std::vector<Eigen::VectorXd>& columns) {
  Eigen::MatrixXd made(columns.front().size(), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t i = 0; i < columns.size(); ++i)
    made.col(static_cast<Eigen::Index>(i)) = columns[i];
  return made;
}

/// Those of a fold's people, or of all others.
learning::Samples pick(const Summaries& scaled, const Material& material, int fold, bool inside) {
  std::vector<Eigen::VectorXd> inputs, outputs;
  for (std::size_t i = 0; i < scaled.takes.size(); ++i) {
    if ((material.folds[scaled.takes[i]] == fold) != inside) continue;
    inputs.push_back(scaled.columns[i]);
    outputs.push_back(Eigen::VectorXd::Constant(static_cast<Eigen::Index>(material.classes.size()),
                                                -wanted_answer));
    outputs.back()[material.truths[static_cast<Eigen::Index>(scaled.takes[i])]] = wanted_answer;
  }
  return {to_matrix(inputs), to_matrix(outputs)};
}

}  // namespace

Expected<Trained> train_networks(const Material& material, Inputs inputs,
                                 const TrainerOptions& options) {
  Summaries shown, more;
  Random random(options.seed);
  for (std::size_t i = 0; i < material.takes.size(); ++i) {
    const Take& take = *material.takes[i];
    add_beginnings(shown, take, i, inputs);
    add_beginnings(more, take, i, inputs);
    for (int copy = 0; copy < options.copies; ++copy)
      add_beginnings(more, varied(take, options, random), i, inputs);
  }
  const auto scale = Whitening::fit(to_matrix(shown.columns));
  if (!scale) return tl::unexpected(scale.error());
  for (Summaries* summaries : {&shown, &more})
    for (Eigen::VectorXd& column : summaries->columns) column = scale->apply(column);
  NetworkClassifier all{inputs, *scale, {}};
  Eigen::MatrixXd unseen = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(material.classes.size()),
                                                 material.truths.size());
  for (int fold = 0; fold < material.fold_count; ++fold) {
    auto result =
        learning::train(pick(more, material, fold, false), pick(shown, material, fold, true),
                        {.hidden = options.hidden,
                         .epochs = options.epochs,
                         .check_every = 5,
                         .patience = options.patience,
                         .seed = options.seed + static_cast<unsigned>(fold)});
    if (!result) return tl::unexpected(result.error());
    all.networks.push_back(result->network);
    const Classifier one = NetworkClassifier{inputs, *scale, {std::move(result->network)}};
    for (std::size_t i = 0; i < material.takes.size(); ++i)
      if (material.folds[i] == fold)
        unseen.col(static_cast<Eigen::Index>(i)) =
            scores_of(one, *material.takes[i], material.classes.size());
  }
  return Trained{std::move(all), std::move(unseen)};
}

}  // namespace prehend::demonstration
