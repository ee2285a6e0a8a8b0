#include "tests/support/models/random_model.hpp"

#include "common/base/random.hpp"

namespace prehend::test {

using mapping::feature_count;
using model::ShapeKind;

mapping::ModelTraits plain_traits(const model::HandModel& hand) {
  const auto dofs = static_cast<Eigen::Index>(hand.dofs().size());
  mapping::ModelTraits traits{"random", "none", mapping::SizeInput::characteristic,
                              Eigen::VectorXd(dofs), Eigen::VectorXd(dofs)};
  for (Eigen::Index i = 0; i < dofs; ++i) {
    traits.lower[i] = hand.dofs()[static_cast<std::size_t>(i)].lower;
    traits.upper[i] = hand.dofs()[static_cast<std::size_t>(i)].upper;
  }
  return traits;
}

mapping::MappingNetwork random_network(const model::HandModel& hand, ShapeKind shape,
                                       std::uint64_t seed, int hidden) {
  Random random(seed);
  const mapping::ModelTraits limits = plain_traits(hand);
  const int inputs = feature_count + (shape == ShapeKind::unknown ? 0 : 1);
  learning::Layer first(hidden, inputs + 1), last(limits.lower.size(), hidden + 1);
  for (learning::Layer* layer : {&first, &last})
    for (Eigen::Index row = 0; row < layer->rows(); ++row)
      for (Eigen::Index col = 0; col < layer->cols(); ++col) (*layer)(row, col) = random.normal();
  Eigen::VectorXd low = Eigen::VectorXd::Constant(inputs, -0.2), high = -low;
  if (inputs > feature_count) low[feature_count] = 0.01, high[feature_count] = 0.08;
  return {shape,
          *learning::Network::create({first, last}),
          *learning::Scaling::create(low, high),
          *learning::Scaling::create(limits.lower, limits.upper),
          {}};
}

mapping::MappingModel random_model(const model::HandModel& hand, std::uint64_t seed, int hidden) {
  return *mapping::MappingModel::create(
      hand, plain_traits(hand),
      {random_network(hand, ShapeKind::unknown, seed, hidden),
       random_network(hand, ShapeKind::cylinder, seed + 1, hidden),
       random_network(hand, ShapeKind::box, seed + 2, hidden)});
}

}  // namespace prehend::test
