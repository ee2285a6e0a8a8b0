#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/base/log.hpp"
#include "common/recording/types/idl.hpp"
#include "common/stage/temporary_folder.hpp"
#include "services/recorder/tools/check/check.hpp"
#include "services/recorder/tools/terminal/progress_line.hpp"

namespace prehend::recorder {
namespace {

using recording::Report;
using recording::TopicReport;

std::string sentence(const TopicReport& topic) {
  if (topic.first.empty()) return "";
  return topic.first.front().text();
}

std::string to_json(const Report& report) {
  using Json = nlohmann::ordered_json;
  Json topics = Json::array();
  for (const TopicReport& topic : report.topics) {
    Json entry{{"name", topic.name}, {"compared", topic.compared}, {"different", topic.different}};
    if (!topic.first.empty()) entry["first_difference"] = sentence(topic);
    topics.push_back(std::move(entry));
  }
  return Json{{"verdict", report.same() ? "same" : "different"}, {"topics", topics}}.dump(
      -1, ' ', false, Json::error_handler_t::replace);
}

std::string to_text(const Checked& checked) {
  std::string text;
  for (const TopicReport& topic : checked.report.topics) {
    text += fmt::format("{:<18}{:>7} compared  ", topic.name, topic.compared);
    text += topic.different == 0 ? "all the same\n"
                                 : fmt::format("{} different ({} missing, {} extra)\n",
                                               topic.different, topic.missing, topic.extra);
    for (const auto& difference : topic.first) text += "    " + difference.text() + "\n";
  }
  return text + fmt::format("{}: {} on {:.1f} s of recording, in {:.1f} s\n",
                            checked.report.same() ? "same" : "different",
                            fmt::join(checked.services, ", "), checked.recorded_s,
                            checked.elapsed_s);
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) switch (c) {
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '&':
        result += "&amp;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += static_cast<unsigned char>(c) < 32 ? ' ' : c;
    }
  return result;
}

/// A test case a topic.
std::string to_junit(const std::string& name, const Checked& checked) {
  std::string cases;
  int failures = 0;
  for (const TopicReport& topic : checked.report.topics) {
    cases += fmt::format("  <testcase classname=\"{}\" name=\"{}\">", escaped(name),
                         escaped(topic.name));
    if (topic.different > 0) {
      ++failures;
      cases += fmt::format("<failure message=\"{} of {} differ\">{}</failure>", topic.different,
                           topic.compared + topic.missing + topic.extra, escaped(sentence(topic)));
    }
    cases += "</testcase>\n";
  }
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"0\" time=\"{:.3f}\">\n{}"
      "</testsuite>\n",
      escaped(name), checked.report.topics.size(), failures, checked.elapsed_s, cases);
}

int run(const std::vector<std::string>& texts) {
  CLI::App app{
      "Runs services on the recorded inputs and compares what they publish with what was\n"
      "recorded. Exit code 0: the same, 1: different, 2: wrong use, 3: it could not be found out.",
      "prehend check"};
  CheckOptions options;
  std::string tolerances, junit;
  bool json = false, rewrite = false, quiet = false, keep = false;
  options.lab.add_to(app);
  app.add_option("recording", options.file, "an .mcap file")->required();
  app.add_option("--service", options.services,
                 "only this one, on its recorded inputs: glove, recognition, mapping or\n"
                 "simulation; repeatable")
      ->type_size(1)
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"glove", "recognition", "mapping", "simulation"}));
  app.add_option("--tolerances", tolerances, "another table than share/prehend/tolerances.toml");
  app.add_option("--junit", junit, "write the verdict as JUnit XML to this file");
  app.add_flag("--update", rewrite, "write the recording again with the answers of now");
  app.add_flag("--keep", keep, "keep what the services said");
  app.add_flag("--json", json, "one JSON document on standard output");
  app.add_flag("--quiet", quiet, "no progress");
  if (const auto code = service::parse(app, texts)) return *code;

  const auto config = options.lab.load();
  if (!config) return service::complain(config.error(), exit_wrong_use);
  const auto types = recording::types::load_contract();
  if (!types) return service::complain(types.error(), exit_broken);
  const auto table = tolerances.empty() ? recording::ToleranceTable::load_defaults()
                                        : recording::ToleranceTable::load(tolerances);
  if (!table) return service::complain(table.error(), exit_wrong_use);
  const auto folder = stage::TemporaryFolder::create(keep);
  if (!folder) return service::complain(folder.error(), exit_broken);
  options.log_folder = folder->path();

  ProgressLine progress(quiet || json);
  const auto checked = check(options, *types, *table, [&](double share) {
    progress.show(fmt::format("checking {:3.0f} %", 100 * share));
  });
  progress.clear();
  if (!checked) return service::complain(checked.error(), exit_broken);
  std::cout << (json ? to_json(checked->report) + "\n" : to_text(*checked)) << std::flush;
  if (!junit.empty()) {
    std::ofstream stream(junit);
    stream << to_junit(options.file.string(), *checked);
    if (!stream.flush()) return service::complain({"cannot be written", junit, ""}, exit_broken);
  }
  if (checked->report.same()) return exit_done;
  if (!rewrite) return exit_no;
  if (const auto updated = update(options.file, *checked); !updated)
    return service::complain(updated.error(), exit_broken);
  log::info("{} now holds these answers", options.file.string());
  return exit_done;
}

}  // namespace
}  // namespace prehend::recorder

int main(int argc, char** argv) {
  return prehend::recorder::run({argv + 1, argv + argc});
}
