#include "services/mapping/files/mapping_model_file.hpp"

#include <fmt/format.h>

#include <cmath>

#include "common/learning/network_message.hpp"
#include "common/proto/mapping_model.pb.h"
#include "common/proto/sealed_file.hpp"

namespace prehend::mapping {

namespace {

constexpr std::string_view kind = "mapping-model";
constexpr double same_limit = 1e-9;  // rad

void write(const learning::Scaling& scaling, messages::ScalingRange& to) {
  to.mutable_minimum()->Add(scaling.minimum().begin(), scaling.minimum().end());
  to.mutable_maximum()->Add(scaling.maximum().begin(), scaling.maximum().end());
  to.set_kind(std::string(to_string(scaling.kind())));
}

void write(const MappingNetwork& network, messages::MappingNetwork& to) {
  if (network.shape != model::ShapeKind::unknown)
    to.set_shape(std::string(to_string(network.shape)));
  to.set_shortcut(network.network.wiring() == learning::Wiring::shortcut);
  learning::write(network.network, *to.mutable_layers());
  write(network.input, *to.mutable_input());
  write(network.output, *to.mutable_output());
  to.mutable_errors()->set_training(network.errors.training);
  to.mutable_errors()->set_validation(network.errors.validation);
  to.mutable_errors()->set_test(network.errors.test);
}

Expected<learning::Scaling> read(const messages::ScalingRange& from) {
  const auto scaling_kind = learning::scaling_from_string(from.kind());
  if (!scaling_kind) return fail(fmt::format("unknown scaling «{}»", from.kind()));
  return learning::Scaling::create(Eigen::VectorXd::Map(from.minimum().data(), from.minimum_size()),
                                   Eigen::VectorXd::Map(from.maximum().data(), from.maximum_size()),
                                   *scaling_kind);
}

Expected<MappingNetwork> read(const messages::MappingNetwork& from) {
  auto shape = model::ShapeKind::unknown;
  if (!from.shape().empty()) {
    const auto known = model::shape_from_string(from.shape());
    if (!known || *known == model::ShapeKind::unknown)
      return fail(fmt::format("unknown shape «{}»", from.shape()));
    shape = *known;
  }
  auto network = learning::read_network(
      from.layers(), from.shortcut() ? learning::Wiring::shortcut : learning::Wiring::layered);
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
Expected<void> check_hand(const messages::MappingModel& message, const model::HandModel& hand,
                          const std::string& made_for) {
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
  if (!made_for.empty() && !message.made_for().empty() && message.made_for() != made_for)
    return fail(fmt::format("was trained for the hand «{}» as it was before", hand.name()));
  return {};
}

}  // namespace

Expected<MappingModel> load_mapping_model(const std::filesystem::path& file,
                                          const model::HandModel& hand,
                                          const std::string& made_for) {
  const std::string hint = "train it again: prehend train --hand " + hand.name();
  const auto refuse = [&](const std::string& what) { return fail(what, file.string(), hint); };
  auto bytes = proto::read_sealed(file, kind);
  if (!bytes) return tl::unexpected(bytes.error());
  messages::MappingModel message;
  if (!message.ParseFromString(*bytes)) return refuse("not a mapping model");
  if (auto ok = check_hand(message, hand, made_for); !ok) return refuse(ok.error().message());
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
                     {},
                     message.made_for()};
  for (const messages::LearntPlace& from : message.places()) {
    const auto shape = model::shape_from_string(from.shape());
    if (!shape || from.seen_size() != 4 || from.place_size() != 3)
      return refuse("a place without shape, size or coordinates");
    traits.places.push_back({*shape, Eigen::Vector4d::Map(from.seen().data()),
                             Eigen::Vector3d::Map(from.place().data())});
  }
  if (message.has_closing()) {
    auto closing = read(message.closing());
    if (!closing) return refuse(closing.error().message());
    traits.closing = std::move(*closing);
  }
  auto made = MappingModel::create(hand, std::move(traits), std::move(networks));
  if (!made) return refuse(made.error().message());
  return made;
}

bool was_made_for(const std::filesystem::path& file, const std::string& made_for) {
  const auto bytes = proto::read_sealed(file, kind);
  messages::MappingModel message;
  return bytes && message.ParseFromString(*bytes) &&
         (message.made_for().empty() || message.made_for() == made_for);
}

Expected<void> save_mapping_model(const std::filesystem::path& file, const MappingModel& model,
                                  const model::HandModel& hand) {
  const ModelTraits& traits = model.traits();
  messages::MappingModel message;
  message.set_hand(hand.name());
  for (const model::HandDof& dof : hand.dofs()) {
    messages::HandDofRange& to = *message.add_dofs();
    to.set_name(dof.name);
    to.set_lower(dof.lower);
    to.set_upper(dof.upper);
  }
  message.set_scheme(traits.scheme);
  message.set_training_set_digest(traits.training_set_digest);
  message.set_made_for(traits.made_for);
  message.set_size_input(std::string(to_string(traits.size_input)));
  message.mutable_lower()->Add(traits.lower.begin(), traits.lower.end());
  message.mutable_upper()->Add(traits.upper.begin(), traits.upper.end());
  message.mutable_precision()->Add(traits.precision.begin(), traits.precision.end());
  for (const PalmOffset& place : traits.places) {
    messages::LearntPlace& to = *message.add_places();
    to.set_shape(std::string(to_string(place.shape)));
    to.mutable_seen()->Add(place.seen.begin(), place.seen.end());
    to.mutable_place()->Add(place.p_GR.begin(), place.p_GR.end());
  }
  for (const MappingNetwork& network : model.networks()) write(network, *message.add_networks());
  if (traits.closing) write(*traits.closing, *message.mutable_closing());
  return proto::write_sealed(file, kind, message.SerializeAsString());
}

}  // namespace prehend::mapping
