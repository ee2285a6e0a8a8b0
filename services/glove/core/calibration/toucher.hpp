#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/glove/core/calibration/registration.hpp"
#include "services/glove/core/calibration/still.hpp"
#include "services/glove/core/processor.hpp"

namespace prehend::glove {

/// Asks a person to touch known points of the table with the index fingertip and takes each when
/// the hand keeps still there. Pure.
class Toucher {
 public:
  /// p_W: where the sensor is when the point is touched, m.
  explicit Toucher(std::vector<Eigen::Vector3d> p_W);

  /// The point to touch now; nothing when all have been.
  std::optional<Eigen::Vector3d> asked() const;
  /// Returns how far the fingertip moved meanwhile, m, once a point is taken.
  std::optional<double> see(const Frame& frame);
  const std::string& waiting_for() const { return waiting_for_; }
  bool redo();

  Expected<Registration> result() const;

 private:
  std::vector<Eigen::Vector3d> p_W_, p_T_;
  Processor processor_;
  StillTaker still_;
  std::string waiting_for_ = "no frames yet";
};

}  // namespace prehend::glove
