#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/base/file_text.hpp"
#include "common/base/log.hpp"
#include "common/base/log_format.hpp"
#include "common/base/to_terminal.hpp"
#include "services/glove/devices/bird_capture.hpp"
#include "services/glove/tools/commands.hpp"

namespace prehend::glove {
namespace {

using Json = nlohmann::ordered_json;

struct DecodeArguments {
  std::vector<std::string> files;
  bool json = false;
};

Json list(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

Json to_json(const std::string& file, const bird::CapturedRecord& captured) {
  const bird::Record& record = captured.record;
  Json line{{"file", file},
            {"t_s", captured.time},
            {"sensor", record.address.value_or(0)},
            {"kind", bird::info(record.format).name},
            {"position_m", nullptr},
            {"rotation", nullptr},
            {"angles_rad", nullptr},
            {"button", nullptr}};
  if (record.position) line["position_m"] = list(*record.position);
  if (const auto R = record.rotation())
    line["rotation"] = {list(R->row(0)), list(R->row(1)), list(R->row(2))};
  if (record.angles) line["angles_rad"] = list(*record.angles);
  if (record.button) line["button"] = *record.button;
  return line;
}

void print(const bird::CapturedRecord& captured) {
  const bird::Record& record = captured.record;
  to_terminal("{:.6f}  sensor {}  {:19}", captured.time, record.address.value_or(0),
              bird::info(record.format).name);
  if (record.position)
    to_terminal("  position {:7.4f} {:7.4f} {:7.4f} m", record.position->x(), record.position->y(),
                record.position->z());
  if (const auto R = record.rotation()) {
    const Eigen::Quaterniond q(*R);
    to_terminal("  rotation {:7.4f} {:7.4f} {:7.4f} {:7.4f}", q.w(), q.x(), q.y(), q.z());
  }
  if (record.button) to_terminal("  button {}", *record.button);
  to_terminal("\n");
}

/// 0 when there was a record to show, 1 when there was none, 3 when a file could not be read.
int decode(const DecodeArguments& arguments) {
  std::size_t records = 0;
  bool unreadable = false;
  for (const std::string& file : arguments.files) {
    const auto text = read_file(file);
    if (!text) {
      log::error(text.error());
      unreadable = true;
      continue;
    }
    const auto capture = bird::read_capture(*text, file);
    if (!capture) {
      // Licences lie beside captures: no reason to call the whole decoding a failure.
      log::warning(capture.error());
      continue;
    }
    if (capture->garbage > 0)
      log::warning("{}: {} bytes belong to no record", file, capture->garbage);
    if (capture->unreadable_lines > 0)
      log::warning("{}: {} lines cannot be read", file, capture->unreadable_lines);
    for (const bird::CapturedRecord& record : capture->records)
      if (arguments.json)
        std::cout << to_json(file, record).dump() << '\n';
      else
        print(record);
    records += capture->records.size();
  }
  if (unreadable) return 3;
  return records > 0 ? 0 : 1;
}

}  // namespace

void add_decode(tool::Program& program) {
  auto* command =
      program.app().add_subcommand("decode", "turn captured serial conversations into records");
  const auto arguments = std::make_shared<DecodeArguments>();
  command->add_option("FILE", arguments->files, "capture, text")->required();
  command->add_flag("--json", arguments->json, "one JSON document a line");
  program.on(*command, [arguments] { return decode(*arguments); });
}

}  // namespace prehend::glove
