#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/base/log_format.hpp"
#include "common/base/to_terminal.hpp"
#include "common/recording/compare/comparison.hpp"
#include "common/recording/compare/recorded_topic.hpp"
#include "services/recorder/tools/recording/commands.hpp"

namespace prehend::recorder {
namespace {

using recording::Comparison;
using recording::Report;
using recording::Side;
using Json = nlohmann::ordered_json;

struct DiffArguments {
  std::string expected, actual;
  std::string tolerances;
  std::vector<std::string> topics;
  std::size_t keep = 5;
  bool json = false;
};

/// One of the two recordings, fed into the comparison message by message.
class Feed {
 public:
  Feed(recording::mcap::Reader& reader, Side side, const std::vector<std::string>& topics)
      : reader_(reader),
        types_(reader),
        side_(side),
        cursor_(reader.messages({.wanted = [&](const recording::mcap::Channel& channel) {
          return matches(topics, recording::recorded_topic(channel, reader.contents()).name);
        }})) {}

  /// False at the end.
  bool step(Comparison& comparison) {
    const auto next = cursor_.next();
    if (!next) {
      log::error(next.error());
      damaged = true;
      return true;
    }
    if (!*next) return false;
    const auto& [channel, message] = **next;
    const auto topic = recording::recorded_topic(*channel, reader_.contents());
    comparison.add(side_, {topic.name, types_.of(*channel), message.data, topic.end});
    return true;
  }

  bool damaged = false;

 private:
  recording::mcap::Reader& reader_;
  recording::RecordedTypes types_;
  Side side_;
  recording::mcap::MessageCursor cursor_;
};

Json report_json(const Report& report) {
  Json document{{"verdict", report.same() ? "same" : "different"}, {"topics", Json::array()}};
  for (const recording::TopicReport& topic : report.topics) {
    Json entry{{"name", topic.name},
               {"compared", topic.compared},
               {"different", topic.different},
               {"missing", topic.missing},
               {"extra", topic.extra}};
    if (!topic.first.empty()) entry["first_difference"] = topic.first.front().text();
    document["topics"].push_back(std::move(entry));
  }
  return document;
}

void print(const Report& report) {
  for (const recording::TopicReport& topic : report.topics) {
    to_terminal("{:24} {:8} compared, {} different", topic.name, topic.compared, topic.different);
    if (topic.missing > 0) to_terminal(", {} missing", topic.missing);
    if (topic.extra > 0) to_terminal(", {} more than expected", topic.extra);
    to_terminal("\n");
    for (const recording::Difference& each : topic.first) to_terminal("    {}\n", each.text());
  }
  to_terminal("{}\n", report.same() ? "same" : "different");
}

int diff(const DiffArguments& arguments) {
  const auto tolerances = arguments.tolerances.empty()
                              ? recording::ToleranceTable::load_defaults()
                              : recording::ToleranceTable::load(arguments.tolerances);
  if (!tolerances) return complain(tolerances.error(), exit_broken);
  auto expected = recording::mcap::Reader::open(arguments.expected);
  if (!expected) return complain_of(arguments.expected, expected.error());
  auto actual = recording::mcap::Reader::open(arguments.actual);
  if (!actual) return complain_of(arguments.actual, actual.error());
  if (!arguments.topics.empty() && matching(arguments.topics, expected->contents()).empty() &&
      matching(arguments.topics, actual->contents()).empty())
    return complain(no_such_topic(arguments.topics, arguments.expected), exit_no);

  Comparison comparison(*tolerances, arguments.keep);
  Feed left(*expected, Side::expected, arguments.topics);
  Feed right(*actual, Side::actual, arguments.topics);
  // In step, so that few samples wait for their partner.
  for (bool more = true; more;) {
    const bool more_left = left.step(comparison), more_right = right.step(comparison);
    more = more_left || more_right;
  }
  const Report report = comparison.finish();
  if (arguments.json)
    std::cout << report_json(report).dump(-1, ' ', false, Json::error_handler_t::replace) << '\n';
  else
    print(report);
  return report.same() && !left.damaged && !right.damaged ? exit_done : exit_no;
}

}  // namespace

void add_diff(tool::Program& program) {
  auto* command = program.app().add_subcommand("diff", "do two recordings say the same");
  const auto arguments = std::make_shared<DiffArguments>();
  command->add_option("EXPECTED", arguments->expected, "recording")->required();
  command->add_option("ACTUAL", arguments->actual, "recording")->required();
  command->add_option("--tolerances", arguments->tolerances,
                      "table of tolerances; the default is share/prehend/tolerances.toml");
  command->add_option("--topic", arguments->topics, "only these; * and ? stand for anything");
  command->add_option("--first", arguments->keep, "differences shown of each topic")
      ->capture_default_str();
  command->add_flag("--json", arguments->json, "one JSON document");
  program.on(*command, [arguments] { return diff(*arguments); });
}

}  // namespace prehend::recorder
