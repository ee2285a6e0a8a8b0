#include "common/learning/network_message.hpp"

#include <utility>
#include <vector>

namespace prehend::learning {

void write(const Network& network, LayerMessages& to) {
  for (const Layer& layer : network.layers()) {
    messages::NetworkLayer& written = *to.Add();
    written.set_outputs(static_cast<unsigned>(layer.rows()));
    for (Eigen::Index row = 0; row < layer.rows(); ++row)
      for (Eigen::Index col = 0; col < layer.cols(); ++col) written.add_weights(layer(row, col));
  }
}

Expected<Network> read_network(const LayerMessages& from, Wiring wiring) {
  std::vector<Layer> layers;
  for (const messages::NetworkLayer& layer : from) {
    const auto rows = static_cast<Eigen::Index>(layer.outputs());
    if (rows == 0 || layer.weights_size() % rows != 0)
      return fail("a layer's weights do not fill its rows");
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    layers.emplace_back(
        Eigen::Map<const RowMajor>(layer.weights().data(), rows, layer.weights_size() / rows));
  }
  return Network::create(std::move(layers), wiring);
}

}  // namespace prehend::learning
