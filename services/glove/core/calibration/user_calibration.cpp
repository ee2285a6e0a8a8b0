#include "services/glove/core/calibration/user_calibration.hpp"

#include <numeric>

namespace prehend::glove {

model::HumanHand UserCalibration::hand() const {
  const model::HumanHand average(scale);
  std::array<double, model::finger_count> fingers{};
  for (std::size_t f = 0; f < fingers.size(); ++f) {
    const auto typical = average.bones(static_cast<model::Finger>(f));
    fingers[f] = std::accumulate(bones[f].begin(), bones[f].end(), 0.0) /
                 std::accumulate(typical.begin(), typical.end(), 0.0);
  }
  return model::HumanHand(scale, fingers);
}

}  // namespace prehend::glove
