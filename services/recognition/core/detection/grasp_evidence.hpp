#pragma once

#include <vector>

#include "common/base/time.hpp"
#include "common/model/grasp_taxonomy.hpp"

namespace prehend::recognition {

/// What a hand was seen to grasp, whatever with.
struct SeenGrasp {
  Time stamp{};
  std::vector<double> p;  // of each class of the taxonomy; they sum to 1
};

/// How much likelier such a hand is on an object of this shape than on things in general, half of
/// which admit a grasp: twice the share of it that the object admits, 0 to 2. 1 where nothing is
/// known of the shape, or no class has half of the hand's probability.
double support(const model::GraspTaxonomy& taxonomy, const std::vector<double>& p,
               const model::Shape& shape);

/// A doubtful probability after a grasp that supports it so: its odds times that. It is never
/// lowered, and never raised above 0.9: a hand does not make anything certain.
double raised(double probability, double support);

}  // namespace prehend::recognition
