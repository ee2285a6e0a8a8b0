#include "services/mapping/tools/study/experiment.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace prehend::mapping {

std::vector<double> Table::operator[](std::string_view column) const {
  const auto at = std::find(columns.begin(), columns.end(), column) - columns.begin();
  const Eigen::VectorXd all = values.col(at);
  return {all.begin(), all.end()};
}

std::string to_csv(const Table& table) {
  std::string csv = fmt::format("repetition,{}\n", fmt::join(table.columns, ","));
  for (Eigen::Index i = 0; i < table.values.rows(); ++i) {
    csv += fmt::format("{}", i);
    for (const double value : table.values.row(i)) csv += fmt::format(",{:.9g}", value);
    csv += '\n';
  }
  return csv;
}

std::vector<Experiment> experiments() {
  return {convergence(),
          lowest_error(),
          hidden_neurons_barrett(),
          hidden_neurons_dlr(),
          hidden_neurons_robonaut(),
          posture_counts(),
          direct_grasps(),
          cylinders(),
          wrong_radius(),
          boxes(),
          wrong_depth(),
          small_cube(),
          scalings(),
          size_inputs(),
          untrained_sizes(),
          real_hands()};
}

std::uint64_t repetition_seed(std::uint64_t study_seed, std::string_view figure,
                              std::size_t index) {
  std::uint64_t hash = 14695981039346656037ull;  // FNV-1a
  const auto mix = [&](std::uint64_t value) { hash = (hash ^ value) * 1099511628211ull; };
  for (const char c : figure) mix(static_cast<unsigned char>(c));
  for (int i = 0; i < 8; ++i) mix(study_seed >> (8 * i) & 0xff);
  for (int i = 0; i < 8; ++i) mix(index >> (8 * i) & 0xff);
  return hash;
}

}  // namespace prehend::mapping
