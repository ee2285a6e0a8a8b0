#pragma once

#include <vector>

#include "common/model/hand_model.hpp"
#include "services/mapping/tools/training/scheme.hpp"

namespace prehend::mapping {

/// The human fingers that drive a robot hand.
enum class Driver { thumb, index, little };

/// Which drives each fingertip, in the hand's order. As hand.toml says («human»), otherwise: the
/// thumb is the finger that closes most against the others; the index finger, of the two at the
/// ends of the others' row, is the one that begins nearer to the thumb; the little one drives the
/// rest.
std::vector<Driver> drivers(const model::HandModel& hand);

/// The scheme of a hand for which nobody wrote one. Each DoF that closes is closed by whoever
/// drives the fingertips that it moves, to most of its range; where these are several, each does
/// its part, so that a hand that closes all fingers closes the whole robot hand. What does not
/// close stays between the hand's postures that are not closed ones; these are the preshapes.
Scheme derive_scheme(const model::HandModel& hand);

/// The scheme in the file, where there is one; else derived.
Expected<Scheme> load_or_derive(const std::filesystem::path& file, const model::HandModel& hand);

}  // namespace prehend::mapping
