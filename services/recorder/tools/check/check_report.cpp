#include "services/recorder/tools/check/check_report.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace prehend::recorder {
namespace {

using recording::Report;
using recording::TopicReport;

std::string sentence(const TopicReport& topic) {
  if (topic.first.empty()) return "";
  return topic.first.front().text();
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

}  // namespace

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

}  // namespace prehend::recorder
