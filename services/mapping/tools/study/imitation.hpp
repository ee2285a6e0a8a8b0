#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/learning/scaling.hpp"
#include "common/learning/training.hpp"
#include "services/mapping/tools/training/demonstrator.hpp"
#include "services/mapping/tools/training/scheme.hpp"

namespace prehend::mapping {

/// The way to train of [Thesis, 5.2], unless an experiment asks for another.
struct ImitationOptions {
  learning::TrainingMethod method = learning::TrainingMethod::rprop;    // of the network
  learning::ScalingKind scaling = learning::ScalingKind::whole_matrix;  // of its inputs
  double size_unit = 1;    // sizes are multiplied by it before scaling; 10: mm beside tips in cm
  int hidden = 4;          // neurons of the one hidden layer
  int epochs = 1000;       // all of them: [Thesis] stops at none of its errors
  bool curve = false;      // keep the errors of every look
  std::uint64_t seed = 1;  // of the first weights
};

/// A network with its scalings, fitted to pairs (a column a pair): nine features, and sizes after
/// them where it knows the object, in m; robot DoF, rad or m.
class Imitation {
 public:
  static Expected<Imitation> fit(const learning::Samples& pairs, const ImitationOptions& options);

  Eigen::VectorXd answer(const Eigen::VectorXd& input) const;
  /// [Thesis, eq. 5.1] for each pair, rad².
  std::vector<double> errors(const learning::Samples& pairs) const;
  /// [Thesis, eq. 5.3], rad²: their mean; not-a-number without pairs.
  double error(const learning::Samples& pairs) const;
  const learning::TrainingResult& training() const { return training_; }

 private:
  Imitation(learning::TrainingResult training, learning::Scaling input, learning::Scaling output,
            double size_unit);
  learning::TrainingResult training_;
  learning::Scaling input_, output_;
  double size_unit_;
};

/// What a person shows of these postures, once each.
learning::Samples show(Demonstrator& person, std::span<const SchemePosture> postures);

/// Pairs one after the other.
learning::Samples joined(std::span<const learning::Samples> parts);

/// The pairs with these numbers, the same for all, after their features.
learning::Samples with_size(const learning::Samples& pairs, const Eigen::VectorXd& size);

}  // namespace prehend::mapping
