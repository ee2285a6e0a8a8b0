#include "services/cli/tools/demo/rows.hpp"

#include <nlohmann/json.hpp>

#include "common/base/file_text.hpp"
#include "common/base/paths.hpp"
#include "common/stage/process.hpp"
#include "common/stage/temporary_folder.hpp"

namespace prehend::cli {
namespace {

using Document = nlohmann::json;

constexpr Duration patience = std::chrono::seconds(10);

/// What a program of ours prints, which must end at once.
Expected<std::string> printed_by(const std::string& program,
                                 const std::vector<std::string>& arguments) {
  auto folder = stage::TemporaryFolder::create(false);
  if (!folder) return tl::unexpected(folder.error());
  stage::Process::Options options;
  options.command = {(program_directory() / program).string()};
  options.command.insert(options.command.end(), arguments.begin(), arguments.end());
  options.log = folder->path() / "log";
  options.output = folder->path() / "output";
  auto process = stage::Process::start(options);
  if (!process) return tl::unexpected(process.error());
  const auto exit = process->wait(patience);
  if (!exit) return fail("does not answer", program);
  if (exit->code != 0) return fail(stage::last_lines(options.log, 5), program);
  return read_file(options.output);
}

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
  return printed_by("prehend-glove-tool", {"devices", "--json"}).and_then(glove_rows);
}

Expected<std::vector<CameraRow>> ask_camera_rows() {
  return printed_by("prehend-camera", {"sources", "--json"}).and_then(camera_rows);
}

}  // namespace prehend::cli
