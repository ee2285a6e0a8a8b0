#pragma once

#include "services/recognition/core/learning/object_models.hpp"

namespace prehend::recognition {

/// The false-alarm model of Chang and Krumm (1999), for a dot product instead of an intersection:
/// the bins of what is not the object are taken as independent, so the similarity of a stranger to
/// a view is a sum of many and normal, with mean and variance from the bins' own; a false alarm is
/// that any of the views reaches a similarity. As strangers to a class serve the views of others.
class FalseAlarm {
 public:
  explicit FalseAlarm(const ObjectModels& models);

  /// The chance that a picture of none of the objects is as similar to a view of this class.
  double probability(int class_index, double similarity) const;

 private:
  struct Normal {
    double mean = 0, deviation = 1;
  };
  std::vector<std::vector<Normal>> views_;  // of each class
};

}  // namespace prehend::recognition
