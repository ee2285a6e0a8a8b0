#pragma once

#include <Eigen/Core>
#include <vector>

namespace prehend::recognition {

/// What the doubt about a classification is judged by: the best class' score, how far it is above
/// the second, and the similarity of that class' nearest view.
struct Grounds {
  int best = -1;  // index of the class; -1 without any
  double score = 0, margin = 0, similarity = 0;
};
Grounds grounds(const Eigen::VectorXf& scores, const Eigen::VectorXf& similarity);

/// How sure a classification is: P(right) = 1 / (1 + exp(-(w . (1, score, margin, similarity)))),
/// fitted on views that the classifier had not seen and on views of classes left out.
struct Calibration {
  Eigen::Vector4d w = Eigen::Vector4d::Zero();
  double probability(const Grounds& grounds) const;
};

/// One classification whose outcome is known.
struct Outcome {
  Grounds grounds;
  bool right = false;
  double weight = 1;
};

/// By logistic regression.
Calibration fit(const std::vector<Outcome>& outcomes);

}  // namespace prehend::recognition
