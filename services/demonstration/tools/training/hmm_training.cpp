#include <array>
#include <limits>

#include "services/demonstration/tools/training/material.hpp"

namespace prehend::demonstration {

namespace {

constexpr int iterations = 8;
constexpr int every_fold = -1;

/// What is chosen within the training people.
struct Choice {
  int states;
  double min_variance, ridge;
};
constexpr std::array choices{Choice{1, 0.5, 0.1}, Choice{3, 0.3, 0.1}, Choice{3, 0.6, 0.1},
                             Choice{5, 0.6, 0.1}};

/// Of all takes but those of a fold.
Expected<Classifier> fit(const Material& material, Inputs inputs, const Choice& choice,
                         int left_out) {
  std::vector<Eigen::MatrixXd> sequences;
  std::vector<int> classes_of, class_of_column;
  Eigen::Index columns = 0;
  for (std::size_t i = 0; i < material.takes.size(); ++i) {
    if (material.folds[i] == left_out) continue;
    const Take& take = *material.takes[i];
    FeatureStream stream(inputs);
    Eigen::MatrixXd sequence(feature_count(inputs), static_cast<Eigen::Index>(take.samples.size()));
    for (Eigen::Index t = 0; t < sequence.cols(); ++t)
      sequence.col(t) = stream.add(take.samples[static_cast<std::size_t>(t)]);
    const int truth = material.truths[static_cast<Eigen::Index>(i)];
    class_of_column.insert(class_of_column.end(), take.samples.size(), truth);
    classes_of.push_back(truth);
    columns += sequence.cols();
    sequences.push_back(std::move(sequence));
  }
  Eigen::MatrixXd all(feature_count(inputs), columns);
  columns = 0;
  for (const Eigen::MatrixXd& sequence : sequences) {
    all.middleCols(columns, sequence.cols()) = sequence;
    columns += sequence.cols();
  }
  auto scale = Whitening::fit_within(all, class_of_column, choice.ridge);
  if (!scale) return tl::unexpected(scale.error());
  std::vector<std::vector<Sequence>> by_class(material.classes.size());
  for (std::size_t i = 0; i < sequences.size(); ++i) {
    Sequence scaled(scale->outputs(), sequences[i].cols());
    for (Eigen::Index t = 0; t < scaled.cols(); ++t)
      scaled.col(t) = scale->apply(sequences[i].col(t));
    by_class[static_cast<std::size_t>(classes_of[i])].push_back(std::move(scaled));
  }
  HmmClassifier made{inputs, std::move(*scale), {}};
  std::vector<Sequence> of_all;  // stands for a kind that only the people left out have shown
  for (const auto& shown : by_class) of_all.insert(of_all.end(), shown.begin(), shown.end());
  for (const auto& own : by_class) {
    const auto& shown = own.empty() ? of_all : own;
    const auto start = GaussianHmm::left_to_right(shown, choice.states, choice.min_variance);
    if (!start) return tl::unexpected(start.error());
    made.models.push_back(baum_welch(*start, shown, iterations, choice.min_variance).model);
  }
  return Classifier(std::move(made));
}

}  // namespace

Expected<Trained> train_hmms(const Material& material, Inputs inputs) {
  Choice chosen = choices.front();
  Eigen::MatrixXd unseen;
  double least = std::numeric_limits<double>::infinity();
  for (const Choice& choice : choices) {
    Eigen::MatrixXd scores = Eigen::MatrixXd::Zero(
        static_cast<Eigen::Index>(material.classes.size()), material.truths.size());
    for (int fold = 0; fold < material.fold_count; ++fold) {
      const auto classifier = fit(material, inputs, choice, fold);
      if (!classifier) return tl::unexpected(classifier.error());
      for (std::size_t i = 0; i < material.takes.size(); ++i)
        if (material.folds[i] == fold)
          scores.col(static_cast<Eigen::Index>(i)) =
              scores_of(*classifier, *material.takes[i], material.classes.size());
    }
    const double loss = best_loss(scores, material.truths);
    if (loss >= least) continue;
    least = loss;
    chosen = choice;
    unseen = std::move(scores);
  }
  auto classifier = fit(material, inputs, chosen, every_fold);
  if (!classifier) return tl::unexpected(classifier.error());
  return Trained{std::move(*classifier), std::move(unseen)};
}

}  // namespace prehend::demonstration
