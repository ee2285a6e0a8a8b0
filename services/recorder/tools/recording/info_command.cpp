#include <fmt/chrono.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/base/log_format.hpp"
#include "common/base/printable.hpp"
#include "common/base/to_terminal.hpp"
#include "services/recorder/tools/recording/commands.hpp"
#include "services/recorder/tools/recording/summary.hpp"

namespace prehend::recorder {
namespace {

using Json = nlohmann::ordered_json;

struct InfoArguments {
  std::string file;
  bool json = false;
};

std::string date(std::uint64_t ns) {
  return fmt::format("{:%Y-%m-%d %H:%M:%S} UTC",
                     fmt::gmtime(static_cast<std::time_t>(ns / 1'000'000'000)));
}

void print(const Json& document) {
  const auto messages = document["messages"].get<std::uint64_t>();
  to_terminal("{} messages in {:.3f} s, {} lost; {:.1f} MB in {} chunks{}\n", messages,
              document["duration_s"].get<double>(), document["lost"].get<std::uint64_t>(),
              static_cast<double>(document["size"].get<std::uint64_t>()) * 1e-6,
              document["chunks"].get<std::size_t>(),
              document["compression"] == "" ? std::string()
                                            : ", " + document["compression"].get<std::string>());
  if (messages > 0)
    to_terminal("from {} to {}\n", date(document["start_ns"].get<std::uint64_t>()),
                date(document["end_ns"].get<std::uint64_t>()));
  for (const Json& topic : document["topics"])
    to_terminal("  {:24} {:10} {}\n", printable(topic["name"].get<std::string>()),
                topic["count"].get<std::uint64_t>(), printable(topic["type"].get<std::string>()));
}

int info(const InfoArguments& arguments) {
  auto reader = recording::mcap::Reader::open(arguments.file);
  if (!reader) return complain_of(arguments.file, reader.error());
  const Json document = summary(*reader);
  if (arguments.json)
    std::cout << document.dump(-1, ' ', false, Json::error_handler_t::replace) << '\n';
  else
    print(document);
  for (const char* kind : {"damage", "remarks"})
    for (const Json& text : document[kind]) log::warning("{}", text.get<std::string>());
  return exit_done;
}

}  // namespace

void add_info(tool::Program& program) {
  auto* command = program.app().add_subcommand("info", "what is in a recording");
  const auto arguments = std::make_shared<InfoArguments>();
  command->add_option("FILE", arguments->file, "recording")->required();
  command->add_flag("--json", arguments->json, "one JSON document");
  program.on(*command, [arguments] { return info(*arguments); });
}

}  // namespace prehend::recorder
