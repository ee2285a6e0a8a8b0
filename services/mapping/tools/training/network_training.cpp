#include "services/mapping/tools/training/network_training.hpp"

#include <algorithm>
#include <utility>

namespace prehend::mapping {
namespace {

/// Room beside the outputs' range, so that the sigmoid can reach its ends.
constexpr double output_margin = 0.1;

learning::Samples scaled(const learning::Samples& samples, const learning::Scaling& input,
                         const learning::Scaling& output) {
  learning::Samples result = samples;
  for (Eigen::Index k = 0; k < samples.inputs.cols(); ++k) {
    result.inputs.col(k) = input.to_unit(samples.inputs.col(k));
    result.outputs.col(k) = output.to_unit(samples.outputs.col(k));
  }
  return result;
}

/// [Thesis, eq. 5.1], rad².
double error(const MappingNetwork& network, const learning::Samples& samples) {
  double sum = 0;
  for (Eigen::Index k = 0; k < samples.inputs.cols(); ++k)
    sum += (network.output.from_unit(
                network.network.evaluate(network.input.to_unit(samples.inputs.col(k)))) -
            samples.outputs.col(k))
               .squaredNorm();
  return sum / static_cast<double>(std::max<Eigen::Index>(samples.inputs.cols(), 1));
}

}  // namespace

Expected<MappingNetwork> train_network(const NetworkSamples& samples, model::ShapeKind shape,
                                       learning::ScalingKind scaling,
                                       const learning::TrainingOptions& options,
                                       const std::function<void(double)>& progress) {
  auto input = learning::Scaling::fit(samples.training.inputs, scaling);
  if (!input) return tl::unexpected(input.error());
  auto output = learning::Scaling::fit(samples.training.outputs,
                                       learning::ScalingKind::each_feature, output_margin);
  if (!output) return tl::unexpected(output.error());
  auto best = learning::train(scaled(samples.training, *input, *output),
                              scaled(samples.validation, *input, *output), options, progress);
  if (!best) return tl::unexpected(best.error());
  MappingNetwork made{shape, std::move(best->network), std::move(*input), std::move(*output), {}};
  made.errors = {error(made, samples.training), error(made, samples.validation),
                 error(made, samples.test)};
  return made;
}

}  // namespace prehend::mapping
