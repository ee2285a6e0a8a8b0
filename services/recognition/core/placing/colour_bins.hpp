#pragma once

#include <Eigen/Core>

namespace prehend::recognition {

/// Fine RGB bins, finer than the palette: bin (r * 16 + g) * 16 + b of the upper four bits.
inline constexpr int bins_a_channel = 16;
inline constexpr int bin_count = bins_a_channel * bins_a_channel * bins_a_channel;

/// 1-2-1 along each channel, then a sum of 1: neighbouring colours are alike, and few pixels must
/// fill many bins.
void smooth(Eigen::VectorXf& bins);

/// Adds what the same surfaces look like in a shadow: every colour darker by some shares of itself.
/// Without it a cast shadow, rare and darker than the table, passes for a part of the object.
void add_shadows(Eigen::VectorXf& bins);

}  // namespace prehend::recognition
