#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "services/demonstration/core/recognition/hand_sample.hpp"

namespace prehend::demonstration {

/// Takes of several people, and what is wrong with where they came from.
struct Takes {
  std::vector<Take> takes;
  std::vector<Error> complaints;       // one a file at most: what, where, what to do
  std::size_t files = 0;               // that were looked at
  std::size_t bad_files = 0;           // of which nothing could be read
  std::size_t rows = 0, bad_rows = 0;  // bad: left out
  std::size_t unknown_numbers = 0;     // that were filled in
};

/// A table with a row a sample, by the names of its columns, in any order:
///   user, object, trial, t_ms, and thumb_F_x_cm, _y_cm, _z_cm for F = index, middle, ring, little:
///   needed (x up, y forward, z left)
///   task, side, action, hand_speed_m_s, wrist_speed_m_s: used where they are there
///   grasp: the kind of grasp; where there is none, object says it
///   shape, size_x_cm, _y_cm, _z_cm: of the object, as in the catalogue; all or none of them
/// A row without user, object, trial or time is left out, and so is one that tells nothing of the
/// fingers; any other number that is missing or not finite is unknown. `task`: of rows that name
/// none. Fails when no row is left.
Expected<Takes> parse_takes(std::string_view text, const std::string& name,
                            const std::string& task);

/// The same as parse_takes() reads. Of takes whose object is known, `object` is its shape.
std::string takes_csv(const std::vector<Take>& takes);

/// All files task*.csv of a folder (or Task*.CSV), in order of name. What cannot be read is a
/// complaint. Fails when there is no take at all.
Expected<Takes> load_takes(const std::filesystem::path& folder);

}  // namespace prehend::demonstration
