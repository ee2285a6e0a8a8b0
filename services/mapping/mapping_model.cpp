#include "mapping_model.hpp"

#include <fmt/format.h>
#include <prehend/messages/mapping_model.pb.h>

#include <algorithm>
#include <cmath>
#include <prehend/proto/sealed_file.hpp>
#include <set>

namespace prehend::mapping {

namespace {

constexpr std::string_view kind = "mapping-model";
constexpr double stretch = 0.1;        // of a feature's range, answered beyond each end
constexpr double tolerance = 0.05;     // of a feature's range: noise, no extrapolation yet
constexpr double same_limit = 1e-9;    // rad
constexpr double little_apart = 0.15;  // less bent than the index finger: it stays out of a grasp

Answer answer(const MappingNetwork& network, const Eigen::VectorXd& asked) {
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

void write(const learning::Scaling& scaling, messages::ScalingRange& to) {
  to.mutable_minimum()->Add(scaling.minimum().begin(), scaling.minimum().end());
  to.mutable_maximum()->Add(scaling.maximum().begin(), scaling.maximum().end());
  to.set_kind(std::string(to_string(scaling.kind())));
}

Expected<learning::Scaling> read(const messages::ScalingRange& from) {
  const auto scaling_kind = learning::scaling_from_string(from.kind());
  if (!scaling_kind) return fail(fmt::format("unknown scaling «{}»", from.kind()));
  return learning::Scaling::create(Eigen::VectorXd::Map(from.minimum().data(), from.minimum_size()),
                                   Eigen::VectorXd::Map(from.maximum().data(), from.maximum_size()),
                                   *scaling_kind);
}

Expected<learning::Network> read_network(const messages::MappingNetwork& from) {
  std::vector<learning::Layer> layers;
  for (const messages::NetworkLayer& layer : from.layers()) {
    const auto rows = static_cast<Eigen::Index>(layer.outputs());
    if (rows == 0 || layer.weights_size() % rows != 0)
      return fail("a layer's weights do not fill its rows");
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    layers.emplace_back(
        Eigen::Map<const RowMajor>(layer.weights().data(), rows, layer.weights_size() / rows));
  }
  return learning::Network::create(
      std::move(layers), from.shortcut() ? learning::Wiring::shortcut : learning::Wiring::layered);
}

Expected<MappingNetwork> read(const messages::MappingNetwork& from) {
  auto shape = model::ShapeKind::unknown;
  if (!from.shape().empty()) {
    const auto known = model::shape_from_string(from.shape());
    if (!known || *known == model::ShapeKind::unknown)
      return fail(fmt::format("unknown shape «{}»", from.shape()));
    shape = *known;
  }
  auto network = read_network(from);
  if (!network) return tl::unexpected(network.error());
  auto input = read(from.input());
  if (!input) return tl::unexpected(input.error());
  auto output = read(from.output());
  if (!output) return tl::unexpected(output.error());
  return MappingNetwork{
      shape,
      std::move(*network),
      std::move(*input),
      std::move(*output),
      {from.errors().training(), from.errors().validation(), from.errors().test()}};
}

/// Whether the file was made for this hand as it is now.
Expected<void> check_hand(const messages::MappingModel& message, const model::HandModel& hand) {
  if (message.hand() != hand.name())
    return fail(
        fmt::format("was trained for the hand «{}», not for «{}»", message.hand(), hand.name()));
  bool same = message.dofs_size() == static_cast<int>(hand.dofs().size());
  for (int i = 0; same && i < message.dofs_size(); ++i) {
    const model::HandDof& dof = hand.dofs()[static_cast<std::size_t>(i)];
    same = message.dofs(i).name() == dof.name &&
           std::abs(message.dofs(i).lower() - dof.lower) < same_limit &&
           std::abs(message.dofs(i).upper() - dof.upper) < same_limit;
  }
  if (!same)
    return fail(fmt::format("was trained for another version of the hand «{}»", hand.name()));
  return {};
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
  for (const LearntPlace& place : traits.places)
    if (auto ok = check(place); !ok) return fail(ok.error().what, traits.scheme);
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

Expected<MappingModel> MappingModel::load(const std::filesystem::path& file,
                                          const model::HandModel& hand) {
  const std::string mend = "train it again: prehend train --hand " + hand.name();
  const auto refuse = [&](const std::string& what) { return fail(what, file.string(), mend); };
  auto bytes = proto::read_sealed(file, kind);
  if (!bytes) return tl::unexpected(bytes.error());
  messages::MappingModel message;
  if (!message.ParseFromString(*bytes)) return refuse("not a mapping model");
  if (auto ok = check_hand(message, hand); !ok) return refuse(ok.error().message());
  std::vector<MappingNetwork> networks;
  for (const messages::MappingNetwork& from : message.networks()) {
    auto network = read(from);
    if (!network) return refuse(network.error().message());
    networks.push_back(std::move(*network));
  }
  const auto size_input = size_input_from_string(message.size_input());
  if (!size_input) return refuse(fmt::format("unknown size input «{}»", message.size_input()));
  ModelTraits traits{message.scheme(),
                     message.training_set_digest(),
                     *size_input,
                     Eigen::VectorXd::Map(message.lower().data(), message.lower_size()),
                     Eigen::VectorXd::Map(message.upper().data(), message.upper_size()),
                     Eigen::VectorXd::Map(message.precision().data(), message.precision_size()),
                     {}};
  for (const messages::LearntPlace& from : message.places()) {
    const auto shape = model::shape_from_string(from.shape());
    if (!shape || from.seen_size() != 4 || from.place_size() != 3)
      return refuse("a place without shape, size or coordinates");
    traits.places.push_back({*shape, Eigen::Vector4d::Map(from.seen().data()),
                             Eigen::Vector3d::Map(from.place().data())});
  }
  auto made = create(hand, std::move(traits), std::move(networks));
  if (!made) return refuse(made.error().message());
  return made;
}

Expected<void> MappingModel::save(const std::filesystem::path& file,
                                  const model::HandModel& hand) const {
  messages::MappingModel message;
  message.set_hand(hand.name());
  for (const model::HandDof& dof : hand.dofs()) {
    messages::HandDofRange& to = *message.add_dofs();
    to.set_name(dof.name);
    to.set_lower(dof.lower);
    to.set_upper(dof.upper);
  }
  message.set_scheme(traits_.scheme);
  message.set_training_set_digest(traits_.training_set_digest);
  message.set_size_input(std::string(to_string(traits_.size_input)));
  message.mutable_lower()->Add(traits_.lower.begin(), traits_.lower.end());
  message.mutable_upper()->Add(traits_.upper.begin(), traits_.upper.end());
  message.mutable_precision()->Add(traits_.precision.begin(), traits_.precision.end());
  for (const LearntPlace& place : traits_.places) {
    messages::LearntPlace& to = *message.add_places();
    to.set_shape(std::string(to_string(place.shape)));
    to.mutable_seen()->Add(place.seen.begin(), place.seen.end());
    to.mutable_place()->Add(place.p_GR.begin(), place.p_GR.end());
  }
  for (const MappingNetwork& network : networks_) {
    messages::MappingNetwork& to = *message.add_networks();
    if (network.shape != model::ShapeKind::unknown)
      to.set_shape(std::string(to_string(network.shape)));
    to.set_shortcut(network.network.wiring() == learning::Wiring::shortcut);
    for (const learning::Layer& layer : network.network.layers()) {
      messages::NetworkLayer& written = *to.add_layers();
      written.set_outputs(static_cast<unsigned>(layer.rows()));
      for (Eigen::Index row = 0; row < layer.rows(); ++row)
        for (Eigen::Index col = 0; col < layer.cols(); ++col) written.add_weights(layer(row, col));
    }
    write(network.input, *to.mutable_input());
    write(network.output, *to.mutable_output());
    to.mutable_errors()->set_training(network.errors.training);
    to.mutable_errors()->set_validation(network.errors.validation);
    to.mutable_errors()->set_test(network.errors.test);
  }
  return proto::write_sealed(file, kind, message.SerializeAsString());
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

Answer MappingModel::direct(const Features& features) const {
  Answer made = answer(networks_.front(), features);
  made.dof = limited(made.dof);
  return made;
}

std::optional<Answer> MappingModel::intelligent(const Features& features, const model::Shape& shape,
                                                const Pose& X_OG) const {
  for (const MappingNetwork& network : networks_)
    if (network.shape == shape.kind && shape.kind != model::ShapeKind::unknown) {
      Eigen::VectorXd input(feature_count + size_count(traits_.size_input, shape.kind));
      input << features, size_numbers(traits_.size_input, shape, X_OG);
      Answer made = answer(network, input);
      made.dof = limited(made.dof);
      return made;
    }
  return std::nullopt;
}

bool MappingModel::knows(model::ShapeKind shape) const {
  return shape != model::ShapeKind::unknown &&
         std::any_of(networks_.begin(), networks_.end(),
                     [&](const MappingNetwork& network) { return network.shape == shape; });
}

}  // namespace prehend::mapping
