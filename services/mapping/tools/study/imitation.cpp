#include "services/mapping/tools/study/imitation.hpp"

#include <limits>
#include <utility>

#include "services/mapping/core/features.hpp"

namespace prehend::mapping {

namespace {

Eigen::VectorXd in_units(Eigen::VectorXd input, double size_unit) {
  input.tail(input.size() - feature_count) *= size_unit;
  return input;
}

}  // namespace

Imitation::Imitation(learning::TrainingResult training, learning::Scaling input,
                     learning::Scaling output, double size_unit)
    : training_(std::move(training)),
      input_(std::move(input)),
      output_(std::move(output)),
      size_unit_(size_unit) {}

Expected<Imitation> Imitation::fit(const learning::Samples& pairs,
                                   const ImitationOptions& options) {
  learning::Samples scaled = pairs;
  for (Eigen::Index k = 0; k < pairs.inputs.cols(); ++k)
    scaled.inputs.col(k) = in_units(pairs.inputs.col(k), options.size_unit);
  auto input = learning::Scaling::fit(scaled.inputs, options.scaling);
  if (!input) return tl::unexpected(input.error());
  auto output = learning::Scaling::fit(pairs.outputs, options.scaling);
  if (!output) return tl::unexpected(output.error());
  for (Eigen::Index k = 0; k < pairs.inputs.cols(); ++k) {
    scaled.inputs.col(k) = input->to_unit(scaled.inputs.col(k));
    scaled.outputs.col(k) = output->to_unit(pairs.outputs.col(k));
  }
  learning::TrainingOptions training;
  training.method = options.method;
  training.hidden = options.hidden;
  training.epochs = training.patience = options.epochs;
  training.check_every = options.curve ? 1 : training.check_every;
  training.curve = options.curve;
  training.seed = static_cast<std::uint32_t>(options.seed);
  auto trained = learning::train(scaled, {}, training);
  if (!trained) return tl::unexpected(trained.error());
  return Imitation(std::move(*trained), std::move(*input), std::move(*output), options.size_unit);
}

Eigen::VectorXd Imitation::answer(const Eigen::VectorXd& input) const {
  return output_.from_unit(training_.network.evaluate(input_.to_unit(in_units(input, size_unit_))));
}

std::vector<double> Imitation::errors(const learning::Samples& pairs) const {
  std::vector<double> each;
  for (Eigen::Index k = 0; k < pairs.inputs.cols(); ++k)
    each.push_back((answer(pairs.inputs.col(k)) - pairs.outputs.col(k)).squaredNorm());
  return each;
}

double Imitation::error(const learning::Samples& pairs) const {
  const auto each = errors(pairs);
  if (each.empty()) return std::numeric_limits<double>::quiet_NaN();
  double sum = 0;
  for (const double e : each) sum += e;
  return sum / static_cast<double>(each.size());
}

learning::Samples show(Demonstrator& person, std::span<const SchemePosture> postures) {
  const auto count = static_cast<Eigen::Index>(postures.size());
  learning::Samples shown{Eigen::MatrixXd(feature_count, count),
                          Eigen::MatrixXd(postures.front().robot.size(), count)};
  for (Eigen::Index k = 0; k < count; ++k) {
    const SchemePosture& posture = postures[static_cast<std::size_t>(k)];
    shown.inputs.col(k) = person.read(person.repeat(posture.human), posture.splay);
    shown.outputs.col(k) = posture.robot;
  }
  return shown;
}

learning::Samples joined(std::span<const learning::Samples> parts) {
  Eigen::Index count = 0;
  for (const learning::Samples& part : parts) count += part.inputs.cols();
  learning::Samples all{Eigen::MatrixXd(parts.front().inputs.rows(), count),
                        Eigen::MatrixXd(parts.front().outputs.rows(), count)};
  Eigen::Index at = 0;
  for (const learning::Samples& part : parts) {
    all.inputs.middleCols(at, part.inputs.cols()) = part.inputs;
    all.outputs.middleCols(at, part.outputs.cols()) = part.outputs;
    at += part.inputs.cols();
  }
  return all;
}

learning::Samples with_size(const learning::Samples& pairs, const Eigen::VectorXd& size) {
  learning::Samples sized{Eigen::MatrixXd(pairs.inputs.rows() + size.size(), pairs.inputs.cols()),
                          pairs.outputs};
  sized.inputs.topRows(pairs.inputs.rows()) = pairs.inputs;
  sized.inputs.bottomRows(size.size()).colwise() = size;
  return sized;
}

}  // namespace prehend::mapping
