#pragma once

#include <string>
#include <vector>

#include "common/base/error.hpp"

namespace prehend::cli {

/// What a demonstration must know of a kind of glove device, as `prehend glove devices` says it:
/// so no device is named here.
struct GloveRow {
  std::string name;
  std::string line;       // where frames come from: serial, udp, file, topic or none
  bool emulator = false;  // `prehend glove emulate` can be it
  std::string tracker;    // the kind on its back, where it measures only joints
};

/// The same of a camera, as `prehend camera sources` says it.
struct CameraRow {
  std::string name;
  bool synthetic = false;  // shows the scene, so what it sees is known exactly
};

/// From the documents that the two commands print. Fail on anything else.
Expected<std::vector<GloveRow>> glove_rows(const std::string& document);
Expected<std::vector<CameraRow>> camera_rows(const std::string& document);

/// Runs the two commands, which are other services' own.
Expected<std::vector<GloveRow>> ask_glove_rows();
Expected<std::vector<CameraRow>> ask_camera_rows();

/// The row of this name. Fails with the names that there are.
template <class Row>
Expected<Row> find_row(const std::vector<Row>& rows, const std::string& name,
                       const std::string& where) {
  std::string known;
  for (const Row& row : rows) {
    if (row.name == name) return row;
    known += (known.empty() ? "" : ", ") + row.name;
  }
  return fail("there is no '" + name + "'", where, "choose one of " + known);
}

/// What --glove names; empty: the first that can be emulated.
Expected<GloveRow> glove_row(const std::vector<GloveRow>& rows, const std::string& name);

}  // namespace prehend::cli
