#include "services/recognition/core/detection/grasp_evidence.hpp"

#include <algorithm>

namespace prehend::recognition {

namespace {

constexpr double seen_at_all = 0.5;  // least probability of a class that a hand shows
constexpr double usual = 0.5;        // share of all things that admit a grasp
constexpr double surest = 0.9;

}  // namespace

double support(const model::GraspTaxonomy& taxonomy, const std::vector<double>& p,
               const model::Shape& shape) {
  const std::vector<double> fit = taxonomy.fit_to_object(shape);
  if (p.size() != fit.size() || !model::is_valid(shape)) return 1;
  double admitted = 0, sure = 0;
  for (std::size_t i = 0; i < fit.size(); ++i) {
    admitted += p[i] * fit[i];
    sure = std::max(sure, p[i]);
  }
  return sure < seen_at_all ? 1 : admitted / usual;
}

double raised(double probability, double support) {
  if (!(support > 1) || probability >= surest) return probability;
  const double odds = probability / (1 - probability) * support;
  return std::min(surest, odds / (1 + odds));
}

}  // namespace prehend::recognition
