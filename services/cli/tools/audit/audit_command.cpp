#include "services/cli/tools/audit/audit_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/audit/record.hpp"
#include "common/base/log.hpp"
#include "common/base/printable.hpp"
#include "common/service/arguments.hpp"

namespace prehend::cli {
namespace {

struct Found {
  std::vector<audit::Record> records;
  std::size_t damaged = 0;  // lines
};

/// A log has 8 MB. What is much larger, or a pipe on which one would wait, is none.
constexpr std::uintmax_t max_size = 256 << 20;

Expected<void> read(const std::filesystem::path& file, Found& found) {
  std::error_code code;
  if (std::filesystem::exists(file, code) && !std::filesystem::is_regular_file(file, code))
    return fail("is no file", file.string(), "name a log of the folder, or none for all");
  if (const auto size = std::filesystem::file_size(file, code); !code && size > max_size)
    return fail("is too large for a log", file.string(), "more than 256 MB");
  std::ifstream stream(file);
  if (!stream) return fail("cannot be read", file.string(), "is it there, and may you read it?");
  for (std::string line; std::getline(stream, line);) {
    if (line.empty()) continue;
    auto record = audit::parse(line);
    if (record)
      found.records.push_back(std::move(*record));
    else
      ++found.damaged;
  }
  return {};
}

/// The logs of the folder.
Expected<std::vector<std::filesystem::path>> logs_in(const std::filesystem::path& folder) {
  std::error_code code;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder, code))
    if (entry.path().extension() == ".jsonl") files.push_back(entry.path());
  if (code) return fail(code.message(), folder.string());
  return files;
}

std::string page(const Found& found) {
  std::string text;
  for (const audit::Record& record : found.records) {
    text += fmt::format("{}  {:<10}{:<14}{}", audit::to_text(record.time), printable(record.hand),
                        audit::event_names.name(record.event), printable(record.who));
    if (!record.what.empty()) text += ": " + printable(record.what);
    if (record.count != 1) text += fmt::format(" ({} times)", record.count);
    text += '\n';
  }
  return text;
}

std::string document(const Found& found) {
  using Json = nlohmann::ordered_json;
  Json events = Json::array();
  for (const audit::Record& record : found.records)
    events.push_back({{"time", audit::to_text(record.time)},
                      {"stamp_ns", to_ns(record.time)},
                      {"hand", record.hand},
                      {"event", std::string(audit::event_names.name(record.event))},
                      {"who", record.who},
                      {"what", record.what},
                      {"count", record.count}});
  return Json{{"events", events}, {"damaged", found.damaged}}.dump(-1, ' ', false,
                                                                   Json::error_handler_t::replace);
}

}  // namespace

int audit_command(const std::vector<std::string>& arguments) {
  CLI::App app{
      "Who led, stopped and released robot hands, from the logs of safety.audit. Exit code 1: "
      "lines are\ndamaged.",
      "prehend audit"};
  service::LabArguments lab;
  std::vector<std::string> files;
  bool json = false;
  lab.add_to(app);
  app.add_option("files", files, "logs; none: those of the folder safety.audit");
  app.add_flag("--json", json, "one JSON document on standard output");
  if (const auto code = service::parse(app, arguments)) return *code;

  std::vector<std::filesystem::path> logs(files.begin(), files.end());
  if (logs.empty()) {
    const auto config = lab.load();
    if (!config) return service::complain(config.error(), exit_wrong_use);
    const auto folder = config->path("safety.audit");
    if (folder.empty())
      return service::complain({"is not set, so no log is kept", "safety.audit",
                                "set it to a folder, or give the files of a log"},
                               exit_wrong_use);
    auto kept = logs_in(folder);
    if (!kept) return service::complain(kept.error(), exit_broken);
    logs = std::move(*kept);
  }
  Found found;
  for (const auto& file : logs)
    if (const auto done = read(file, found); !done)
      return service::complain(done.error(), exit_broken);
  std::stable_sort(found.records.begin(), found.records.end(),
                   [](const auto& a, const auto& b) { return a.time < b.time; });
  std::cout << (json ? document(found) + "\n" : page(found));
  if (found.damaged > 0 && !json) log::warning("{} damaged lines", found.damaged);
  return found.damaged > 0 ? exit_no : exit_done;
}

}  // namespace prehend::cli
