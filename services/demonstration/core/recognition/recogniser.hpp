#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/demonstration/core/recognition/classifier.hpp"
#include "services/demonstration/core/recognition/distribution.hpp"

namespace prehend::demonstration {

/// How grasps are recognised.
enum class Method {
  posture,     // static networks on the hand's shape
  trajectory,  // networks on the hand's direction and speed
  hmm,         // hidden Markov models on shape, direction and speed
  hybrid       // networks on all of it together with the hidden Markov models
};

inline constexpr std::array methods{Method::hybrid, Method::posture, Method::trajectory,
                                    Method::hmm};
std::string_view to_string(Method method);
std::optional<Method> method_from_string(std::string_view name);

/// A classifier's share in an answer: its scores count times `weight`.
struct Part {
  double weight = 1;
  Classifier classifier;
};

/// Which kind of grasp is it? A value; several threads may ask it.
class Recogniser {
 public:
  /// Refuses fewer than two classes, one that is there twice, parts that do not fit, and a
  /// temperature that is not above 0.
  static Expected<Recogniser> create(Method method, std::vector<std::string> classes,
                                     std::vector<Part> parts, double temperature);

  Method method() const { return method_; }
  const std::vector<std::string>& classes() const { return classes_; }
  const std::vector<Part>& parts() const { return parts_; }
  double temperature() const { return temperature_; }

  /// Of a whole grasp; without samples every class is as likely.
  Distribution recognise(const std::vector<HandSample>& samples) const;

 private:
  Recogniser() = default;
  Method method_{};
  std::vector<std::string> classes_;
  std::vector<Part> parts_;
  double temperature_ = 1;
};

/// Answers while a grasp goes on. Keeps a reference to the recogniser.
class RecogniserStream {
 public:
  explicit RecogniserStream(const Recogniser& recogniser);
  /// After all samples so far. The answer only gets surer: one that is less sure than the one
  /// before does not replace it.
  const Distribution& add(const HandSample& sample);
  /// As it follows from all samples so far, surer or not.
  const Distribution& latest() const { return latest_; }
  const Eigen::VectorXd& scores() const { return scores_; }

 private:
  const Recogniser* recogniser_;
  std::vector<ClassifierStream> parts_;
  Eigen::VectorXd scores_;
  Distribution latest_, surest_;
};

}  // namespace prehend::demonstration
