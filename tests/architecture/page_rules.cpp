// Pages: where their links lead, and how long they are.
#include <cctype>

#include "tests/architecture/decisions.hpp"
#include "tests/architecture/rules.hpp"

namespace prehend::architecture {
namespace {

constexpr int max_service_words = 1200;
constexpr int max_decision_words = 250;

// What stands between ` and ` is no link.
std::string without_quotes(std::string line) {
  bool quote = false;
  for (char& c : line) {
    if (c == '`') quote = !quote;
    if (quote) c = ' ';
  }
  return line;
}

std::vector<std::string> links_of(const std::string& line) {
  std::vector<std::string> links;
  for (auto at = line.find("]("); at != std::string::npos; at = line.find("](", at + 1)) {
    const auto end = line.find_first_of(" )", at + 2);
    if (end != std::string::npos) links.push_back(line.substr(at + 2, end - at - 2));
  }
  return links;
}

bool leads_away(std::string_view link) {
  return link.find(':') != std::string_view::npos;
}

void report_links(const File& page, const House& house, Violations& violations) {
  bool fenced = false;
  for (std::size_t i = 0; i < page.lines.size(); ++i) {
    if (page.lines[i].starts_with("```")) fenced = !fenced;
    if (fenced) continue;
    for (const std::string& link : links_of(without_quotes(page.lines[i]))) {
      if (leads_away(link)) continue;
      const auto stops = [&](const std::string& what) {
        violations.push_back({page.path, static_cast<int>(i + 1), link + what});
      };
      const std::filesystem::path folder = folder_of(page.path);
      std::string target =
          (folder / link.substr(0, link.find('#'))).lexically_normal().generic_string();
      if (target.ends_with("/")) target.pop_back();
      if (link.find('#') != std::string::npos) {
        stops(" points into a page: headings change, name the page");
      } else if (!house.paths.contains(target)) {
        stops(" leads nowhere");
      }
    }
  }
}

void report_length(const File& page, int max_words, Violations& violations) {
  int count = 0;
  for (const std::string& line : page.lines) count += static_cast<int>(words_of(line).size());
  if (count > max_words)
    violations.push_back({page.path, 1,
                          "has " + std::to_string(count) + " words, at most " +
                              std::to_string(max_words) + " are read"});
}

}  // namespace

Violations broken_pages(const House& house, const Agreed&) {
  Violations violations;
  for (const File& page : house.pages) {
    report_links(page, house, violations);
    if (page.path.starts_with("services/")) report_length(page, max_service_words, violations);
    if (page.path.starts_with("docs/decisions/") && page.path != decisions_page)
      report_length(page, max_decision_words, violations);
  }
  return violations;
}

}  // namespace prehend::architecture
