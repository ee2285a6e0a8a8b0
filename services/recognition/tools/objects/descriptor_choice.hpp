#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/recognition/files/dataset.hpp"

namespace CLI {
class App;
}

namespace prehend::recognition {

/// The options of a descriptor on the command line, over what suits the pictures.
class DescriptorChoice {
 public:
  void add_to(CLI::App& command);
  Expected<DescriptorOptions> options(const Dataset& dataset) const;

 private:
  std::string purpose_, colour_space_, constancy_, weighting_;
  std::optional<int> colours_, varied_, parts_;
  std::optional<double> brightness_, same_pairs_;
  std::vector<int> distances_;
};

}  // namespace prehend::recognition
