#include "services/tally/core/tally.hpp"

namespace prehend::tally {

bool Tally::add(const std::string& grasp, bool held) {
  if (!known_.insert(grasp).second) return false;
  held_ += held;
  return true;
}

}  // namespace prehend::tally
