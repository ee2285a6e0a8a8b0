#include "services/demonstration/files/recogniser_file.hpp"

#include <fmt/format.h>

#include "common/base/named_values.hpp"
#include "common/learning/network_message.hpp"
#include "common/proto/grasp_recogniser.pb.h"
#include "common/proto/sealed_file.hpp"

namespace prehend::demonstration {

namespace {

constexpr std::string_view kind = "grasp-recogniser";

constexpr auto input_names = named_values<Inputs>(
    {{Inputs::posture, "posture"}, {Inputs::motion, "motion"}, {Inputs::both, "both"}});

void write(const Eigen::MatrixXd& matrix, messages::Numbers& to) {
  to.set_rows(static_cast<unsigned>(matrix.rows()));
  to.mutable_values()->Add(matrix.data(), matrix.data() + matrix.size());
}

Expected<Eigen::MatrixXd> read(const messages::Numbers& from) {
  const auto rows = static_cast<Eigen::Index>(from.rows());
  if (rows == 0 && from.values_size() == 0) return Eigen::MatrixXd();
  if (rows == 0 || from.values_size() % rows != 0) return fail("numbers do not fill a matrix");
  return Eigen::MatrixXd(
      Eigen::MatrixXd::Map(from.values().data(), rows, from.values_size() / rows));
}

Eigen::VectorXd vector_of(const google::protobuf::RepeatedField<double>& values) {
  return Eigen::VectorXd::Map(values.data(), values.size());
}

void write(const Whitening& scale, messages::FeatureScale& to) {
  to.mutable_mean()->Add(scale.mean().begin(), scale.mean().end());
  to.mutable_deviation()->Add(scale.deviation().begin(), scale.deviation().end());
  if (scale.turn().size() > 0) write(scale.turn(), *to.mutable_turn());
}

Expected<Whitening> read(const messages::FeatureScale& from) {
  auto turn = read(from.turn());
  if (!turn) return tl::unexpected(turn.error());
  return Whitening::create(vector_of(from.mean()), vector_of(from.deviation()), std::move(*turn));
}

void write(const GaussianHmm& model, messages::HiddenMarkovModel& to) {
  const HmmParameters& parameters = model.parameters();
  to.mutable_initial()->Add(parameters.initial.begin(), parameters.initial.end());
  write(parameters.transition, *to.mutable_transition());
  write(parameters.means, *to.mutable_means());
  write(parameters.variances, *to.mutable_variances());
}

Expected<GaussianHmm> read(const messages::HiddenMarkovModel& from) {
  HmmParameters parameters{vector_of(from.initial()), {}, {}, {}};
  for (const auto& [message, to] : {std::pair(&from.transition(), &parameters.transition),
                                    std::pair(&from.means(), &parameters.means),
                                    std::pair(&from.variances(), &parameters.variances)}) {
    auto matrix = read(*message);
    if (!matrix) return tl::unexpected(matrix.error());
    *to = std::move(*matrix);
  }
  return GaussianHmm::create(std::move(parameters));
}

void write(const Part& part, messages::GraspClassifier& to) {
  to.set_weight(part.weight);
  if (const auto* networks = std::get_if<NetworkClassifier>(&part.classifier)) {
    to.set_inputs(std::string(input_names.name(networks->inputs)));
    write(networks->scale, *to.mutable_scale());
    for (const learning::Network& network : networks->networks)
      learning::write(network, *to.add_networks()->mutable_layers());
    return;
  }
  const auto& hmms = std::get<HmmClassifier>(part.classifier);
  to.set_inputs(std::string(input_names.name(hmms.inputs)));
  write(hmms.scale, *to.mutable_scale());
  for (const GaussianHmm& model : hmms.models) write(model, *to.add_hidden_markov_models());
}

Expected<Part> read(const messages::GraspClassifier& from) {
  const auto inputs = input_names.value(from.inputs());
  if (!inputs) return fail(fmt::format("unknown inputs «{}»", from.inputs()));
  auto scale = read(from.scale());
  if (!scale) return tl::unexpected(scale.error());
  if ((from.networks_size() == 0) == (from.hidden_markov_models_size() == 0))
    return fail("a classifier has networks and hidden Markov models, or neither");
  if (from.networks_size() > 0) {
    NetworkClassifier made{*inputs, std::move(*scale), {}};
    for (const messages::GraspNetwork& message : from.networks()) {
      auto network = learning::read_network(message.layers());
      if (!network) return tl::unexpected(network.error());
      made.networks.push_back(std::move(*network));
    }
    return Part{from.weight(), std::move(made)};
  }
  HmmClassifier made{*inputs, std::move(*scale), {}};
  for (const messages::HiddenMarkovModel& message : from.hidden_markov_models()) {
    auto model = read(message);
    if (!model) return tl::unexpected(model.error());
    made.models.push_back(std::move(*model));
  }
  return Part{from.weight(), std::move(made)};
}

void write(const ObjectLikelihood& objects, messages::GraspObjects& to) {
  to.mutable_otherwise()->Add(objects.otherwise().begin(), objects.otherwise().end());
  for (const ObjectLikelihood::Sizes& each : objects.sizes()) {
    messages::GraspObjectSizes& sizes = *to.add_sizes();
    sizes.set_kind(static_cast<unsigned>(each.kind));
    sizes.set_shape(std::string(model::to_string(each.shape)));
    sizes.set_share(each.share);
    if (each.shown.size() > 0) write(each.shown, *sizes.mutable_shown());
  }
}

/// None was stored: nobody measured an object.
Expected<std::optional<ObjectLikelihood>> read(const messages::GraspObjects& from,
                                               std::size_t classes) {
  if (from.sizes_size() == 0 && from.otherwise_size() == 0) return std::nullopt;
  if (static_cast<std::size_t>(from.otherwise_size()) != classes)
    return fail("what objects say is of other classes");
  std::vector<ObjectLikelihood::Sizes> sizes;
  for (const messages::GraspObjectSizes& message : from.sizes()) {
    const auto shape = model::shape_from_string(message.shape());
    if (!shape) return fail(fmt::format("unknown shape «{}»", message.shape()));
    auto shown = read(message.shown());
    if (!shown) return tl::unexpected(shown.error());
    sizes.push_back({message.kind(), *shape, message.share(), std::move(*shown), {}});
  }
  auto made = ObjectLikelihood::create(std::move(sizes),
                                       {from.otherwise().begin(), from.otherwise().end()});
  if (!made) return tl::unexpected(made.error());
  return std::optional(std::move(*made));
}

Expected<TaskRecogniser> read(const messages::GraspRecogniser& from) {
  const auto method = method_from_string(from.method());
  if (!method) return fail(fmt::format("unknown method «{}»", from.method()));
  std::vector<Part> parts;
  for (const messages::GraspClassifier& message : from.classifiers()) {
    auto part = read(message);
    if (!part) return tl::unexpected(part.error());
    parts.push_back(std::move(*part));
  }
  auto recogniser = Recogniser::create(*method, {from.classes().begin(), from.classes().end()},
                                       std::move(parts), from.temperature());
  if (!recogniser) return tl::unexpected(recogniser.error());
  auto objects = read(from.objects(), recogniser->classes().size());
  if (!objects) return tl::unexpected(objects.error());
  return TaskRecogniser{from.task(), std::move(*recogniser), from.people(), from.takes(),
                        std::move(*objects)};
}

}  // namespace

Expected<void> save_recognisers(const std::filesystem::path& file,
                                const std::vector<TaskRecogniser>& recognisers) {
  messages::GraspRecogniserSet set;
  for (const TaskRecogniser& from : recognisers) {
    messages::GraspRecogniser& to = *set.add_recognisers();
    to.set_task(from.task);
    to.set_method(std::string(to_string(from.recogniser.method())));
    for (const std::string& name : from.recogniser.classes()) to.add_classes(name);
    for (const Part& part : from.recogniser.parts()) write(part, *to.add_classifiers());
    to.set_temperature(from.recogniser.temperature());
    to.set_people(from.people);
    to.set_takes(from.takes);
    if (from.objects) write(*from.objects, *to.mutable_objects());
  }
  return proto::write_sealed(file, kind, set.SerializeAsString());
}

Expected<std::vector<TaskRecogniser>> load_recognisers(const std::filesystem::path& file) {
  const auto refuse = [&](const std::string& what) {
    return fail(what, file.string(), "train it again: prehend demonstration train");
  };
  const auto bytes = proto::read_sealed(file, kind);
  if (!bytes) return tl::unexpected(bytes.error());
  messages::GraspRecogniserSet set;
  if (!set.ParseFromString(*bytes)) return refuse("holds no recognisers of grasps");
  std::vector<TaskRecogniser> made;
  for (const messages::GraspRecogniser& message : set.recognisers()) {
    auto recogniser = read(message);
    if (!recogniser) return refuse(recogniser.error().message());
    made.push_back(std::move(*recogniser));
  }
  if (made.empty()) return refuse("holds no recognisers of grasps");
  return made;
}

}  // namespace prehend::demonstration
