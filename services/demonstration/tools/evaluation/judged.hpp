#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "services/demonstration/core/recognition/distribution.hpp"

namespace prehend::demonstration {

/// A grasp of which is known what it was, and what was answered.
struct Judged {
  std::string user;
  std::size_t truth = 0;  // index of its class
  Distribution answer;    // over all classes
  /// The likeliest class at each sample of the stream, and how sure it was.
  std::vector<std::size_t> stream;

  std::size_t best() const;
  double sureness() const { return answer.maxCoeff(); }
  bool right() const { return best() == truth; }
};

double accuracy(const std::vector<Judged>& grasps);

/// Mean over grasps of the sum over classes of (probability − outcome)²: 0 is perfect, 2 the worst
/// [Brier1950].
double brier(const std::vector<Judged>& grasps);

/// Share that is right among the surest grasps that make up `coverage` of all.
double accuracy_at(const std::vector<Judged>& grasps, double coverage);

/// Share that is right after this share of each grasp's samples.
double accuracy_after(const std::vector<Judged>& grasps, double share);

/// Counts: row the truth, column the answer.
std::vector<std::vector<int>> confusion(const std::vector<Judged>& grasps, std::size_t classes);

/// Grasps whose sureness lies in one of ten equal parts of 0..1: what was said and what held.
struct Bin {
  double said = 0, held = 0;
  std::size_t count = 0;
};
std::array<Bin, 10> reliability(const std::vector<Judged>& grasps);

/// Share of answers in the same family as the truth; family: of each class.
double family_accuracy(const std::vector<Judged>& grasps, const std::vector<std::size_t>& family);

/// Standard deviation of the accuracy between people.
double deviation_between_people(const std::vector<Judged>& grasps);

}  // namespace prehend::demonstration
