#pragma once

#include <memory>
#include <string_view>

#include "services/recognition/core/learning/training.hpp"

namespace prehend::recognition {

/// Whatever learns classes from views and names the class of another view.
class Recogniser {
 public:
  struct PhotoAnswer {
    int best = -1;           // index of the class as it was learned; -1: none
    double probability = 0;  // that this is right
  };
  virtual ~Recogniser() = default;
  virtual Expected<void> learn(const std::vector<TrainingClass>& classes) = 0;
  virtual PhotoAnswer name(const TrainingView& view) const = 0;
};

enum class Method {
  learned,       // colour cooccurrence, kernel ridge classifier
  nearest_view,  // colour cooccurrence, the most similar view
  false_alarm,   // as nearest_view, doubted by the false-alarm model (false_alarm.hpp)
  histogram,     // plain colour histogram: the same with pairs at distance 0
  sift,          // features of OpenCV, each votes for the class of its nearest one
};
std::string_view to_string(Method method);

/// `options` are those of the descriptor; SIFT has none.
std::unique_ptr<Recogniser> make_recogniser(Method method, const DescriptorOptions& options);

/// One that has learned already; classes have the models' numbers.
std::unique_ptr<Recogniser> recogniser_of(ObjectModels models, Method method);

}  // namespace prehend::recognition
