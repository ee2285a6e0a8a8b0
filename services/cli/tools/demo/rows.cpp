#include "services/cli/tools/demo/rows.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/stage/process.hpp"

namespace prehend::cli {
namespace {

using Document = nlohmann::json;

constexpr Duration patience = std::chrono::seconds(10);

/// Each entry of the document's one list as a row. There is at least one.
template <class Row, class Read>
Expected<std::vector<Row>> rows_of(const std::string& document, const char* list, Read read) {
  try {
    std::vector<Row> rows;
    const Document root = Document::parse(document);
    for (const Document& entry : root.at(list)) rows.push_back(read(entry));
    if (!rows.empty()) return rows;
  } catch (const Document::exception&) {
    // Said below: what the parser says of it helps nobody.
  }
  return fail("is no table of them", list, "are all programs of one build?");
}

}  // namespace

Expected<std::vector<GloveRow>> glove_rows(const std::string& document) {
  return rows_of<GloveRow>(document, "devices", [](const Document& entry) {
    const Document& tracker = entry.at("tracker");
    return GloveRow{.name = entry.at("name"),
                    .line = entry.at("line"),
                    .emulator = entry.at("emulator"),
                    .tracker = tracker.is_null() ? std::string() : tracker.get<std::string>()};
  });
}

Expected<std::vector<CameraRow>> camera_rows(const std::string& document) {
  return rows_of<CameraRow>(document, "sources", [](const Document& entry) {
    return CameraRow{.name = entry.at("name"), .synthetic = entry.at("from_scene")};
  });
}

Expected<std::vector<GloveRow>> ask_glove_rows() {
  return stage::printed_by("prehend-glove-tool", {"devices", "--json"}, patience)
      .and_then(glove_rows);
}

Expected<std::vector<CameraRow>> ask_camera_rows() {
  return stage::printed_by("prehend-camera", {"sources", "--json"}, patience).and_then(camera_rows);
}

Expected<GloveRow> glove_row(const std::vector<GloveRow>& rows, const std::string& name) {
  if (!name.empty()) return find_row(rows, name, "--glove");
  const auto first =
      std::find_if(rows.begin(), rows.end(), [](const GloveRow& row) { return row.emulator; });
  if (first == rows.end())
    return fail("no device can be emulated", "--glove", "name one, and plug it in");
  return *first;
}

}  // namespace prehend::cli
