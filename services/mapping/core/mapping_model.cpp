#include "services/mapping/core/mapping_model.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace prehend::mapping {

namespace {

constexpr double stretch = 0.1;        // of a feature's range, answered beyond each end
constexpr double tolerance = 0.05;     // of a feature's range: noise, no extrapolation yet
constexpr double same_limit = 1e-9;    // rad
constexpr double little_apart = 0.15;  // less bent than the index finger: it stays out of a grasp

const int closing_inputs = feature_count + size_count(SizeInput::seen, model::ShapeKind::unknown);

NetworkAnswer answer(const MappingNetwork& network, const Eigen::VectorXd& asked) {
  const Eigen::VectorXd& low = network.input.minimum();
  const Eigen::VectorXd& high = network.input.maximum();
  Eigen::VectorXd range = high - low;
  range.tail(asked.size() - feature_count).setZero();  // sizes: see the header
  constexpr double rounding = 1e-9;                    // m
  const Eigen::ArrayXd noise = tolerance * range.array() + rounding;
  const bool extrapolating =
      ((low - asked).array() > noise).any() || ((asked - high).array() > noise).any();
  const Eigen::VectorXd inside =
      asked.cwiseMax(low - stretch * range).cwiseMin(high + stretch * range);
  return {network.output.from_unit(network.network.evaluate(network.input.to_unit(inside))),
          extrapolating};
}

}  // namespace

Expected<MappingModel> MappingModel::create(const model::HandModel& hand, ModelTraits traits,
                                            std::vector<MappingNetwork> networks) {
  const auto dofs = static_cast<Eigen::Index>(hand.dofs().size());
  if (traits.lower.size() != dofs || traits.upper.size() != dofs)
    return fail("wrong number of limits", traits.scheme);
  for (Eigen::Index i = 0; i < dofs; ++i) {
    const model::HandDof& dof = hand.dofs()[static_cast<std::size_t>(i)];
    // Written so that not-a-number fails.
    if (!(traits.lower[i] >= dof.lower - same_limit && traits.upper[i] <= dof.upper + same_limit &&
          traits.lower[i] <= traits.upper[i]))
      return fail("limits that are not the hand's", dof.name);
  }
  if (traits.precision.size() != 0 && traits.precision.size() != feature_count + 1)
    return fail("wrong number of weights for precision grasps", traits.scheme);
  if (!traits.precision.allFinite())
    return fail("weights for precision grasps are not finite", traits.scheme);
  for (const PalmOffset& place : traits.places)
    if (auto ok = check(place); !ok) return fail(ok.error().what, traits.scheme);
  if (const auto& closing = traits.closing;
      closing &&
      (closing->network.inputs() != closing_inputs || closing->network.outputs() != 1 ||
       closing->input.minimum().size() != closing_inputs || closing->output.minimum().size() != 1))
    return fail("wrong number of inputs or outputs", "closing");
  std::set<model::ShapeKind> shapes;
  for (const MappingNetwork& network : networks) {
    const bool direct = network.shape == model::ShapeKind::unknown;
    const std::string name = direct ? "direct" : std::string(to_string(network.shape));
    if (!shapes.insert(network.shape).second) return fail("two networks", name);
    const int sizes = direct ? 0 : size_count(traits.size_input, network.shape);
    if (network.network.inputs() != feature_count + sizes ||
        network.input.minimum().size() != network.network.inputs())
      return fail("wrong number of inputs", name);
    if (network.network.outputs() != static_cast<int>(hand.dofs().size()) ||
        network.output.minimum().size() != network.network.outputs())
      return fail("wrong number of outputs", name);
  }
  if (!shapes.contains(model::ShapeKind::unknown)) return fail("no direct network");
  std::stable_sort(networks.begin(), networks.end(),
                   [](const auto& a, const auto& b) { return a.shape < b.shape; });
  MappingModel made;
  made.traits_ = std::move(traits);
  made.networks_ = std::move(networks);
  return made;
}

Eigen::VectorXd MappingModel::limited(const Eigen::VectorXd& dof) const {
  return dof.cwiseMax(traits_.lower).cwiseMin(traits_.upper);
}

bool MappingModel::is_precision(const Features& features) const {
  const Eigen::VectorXd& learnt = traits_.precision;
  if (learnt.size() == 0) {
    const Eigen::Vector3d bent = bending(features);
    return bent[1] - bent[2] > little_apart;
  }
  return learnt.head<feature_count>().dot(features) + learnt[feature_count] > 0;
}

NetworkAnswer MappingModel::direct(const Features& features) const {
  NetworkAnswer made = answer(networks_.front(), features);
  made.dof = limited(made.dof);
  return made;
}

std::optional<NetworkAnswer> MappingModel::intelligent(const Features& features,
                                                       const model::Shape& shape,
                                                       const Pose& X_OG) const {
  const auto known = known_as(shape);
  if (!known) return std::nullopt;
  Eigen::VectorXd input(feature_count + size_count(traits_.size_input, known->kind));
  input << features, size_numbers(traits_.size_input, *known, X_OG);
  NetworkAnswer made = answer(*find(known->kind), input);
  made.dof = limited(made.dof);
  return made;
}

std::optional<ClosingAnswer> MappingModel::closing(const Features& features,
                                                   const model::Shape& shape,
                                                   const Pose& X_OG) const {
  if (!traits_.closing) return std::nullopt;
  Eigen::VectorXd input(closing_inputs);
  input << features, size_numbers(SizeInput::seen, shape, X_OG);
  const NetworkAnswer made = answer(*traits_.closing, input);
  return ClosingAnswer{std::clamp(made.dof[0], 0.0, 1.0), made.extrapolating};
}

const MappingNetwork* MappingModel::find(model::ShapeKind shape) const {
  if (shape == model::ShapeKind::unknown) return nullptr;
  const auto found =
      std::find_if(networks_.begin(), networks_.end(),
                   [&](const MappingNetwork& network) { return network.shape == shape; });
  return found == networks_.end() ? nullptr : &*found;
}

std::optional<model::Shape> MappingModel::known_as(const model::Shape& shape) const {
  for (const model::Shape& as : {shape, model::like_known(shape)})
    if (find(as.kind)) return as;
  return std::nullopt;
}

}  // namespace prehend::mapping
