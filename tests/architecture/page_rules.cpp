// Pages: where their links lead, and how long they and their sections are.
#include <map>
#include <set>

#include "tests/architecture/decisions.hpp"
#include "tests/architecture/markdown.hpp"
#include "tests/architecture/rules.hpp"

namespace prehend::architecture {
namespace {

constexpr int max_page_words = 1600;
constexpr int max_section_words = 250;
constexpr int max_decision_words = 250;

/// Slugs of the headings of each page.
using Headings = std::map<std::string, std::set<std::string>>;

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

// A page's path, from the root, of a link in `page`; the page itself of #heading.
std::string target_of(const std::string& link, const File& page) {
  if (link.starts_with("#")) return page.path;
  const std::filesystem::path folder = folder_of(page.path);
  std::string target =
      (folder / link.substr(0, link.find('#'))).lexically_normal().generic_string();
  if (target.ends_with("/")) target.pop_back();
  return target;
}

// What is wrong with a link of a page; nothing, if it leads somewhere.
std::string fault_of(const std::string& link, const File& page, const House& house,
                     const Headings& headings) {
  const std::string target = target_of(link, page);
  if (!house.paths.contains(target)) return link + " leads nowhere";
  const auto hash = link.find('#');
  if (hash == std::string::npos) return {};
  const auto found = headings.find(target);
  if (found == headings.end()) return link + " points into what is no page";
  if (found->second.contains(link.substr(hash + 1))) return {};
  std::string names;
  for (const std::string& slug : found->second) names += (names.empty() ? " #" : ", #") + slug;
  return link + " is no heading there; there are" + (names.empty() ? " none" : names);
}

void report_links(const File& page, const House& house, const Headings& headings,
                  Violations& violations) {
  for (const Line& line : prose_of(page))
    for (const std::string& link : links_of(without_quotes(*line.text)))
      if (!leads_away(link))
        if (std::string fault = fault_of(link, page, house, headings); !fault.empty())
          violations.push_back({page.path, line.number, std::move(fault)});
}

void report_length(const File& page, int max_words, Exceptions& long_pages,
                   Violations& violations) {
  const auto report = [&](int line, const std::string& what, int count, int max) {
    if (count > max && !long_pages.allow(page.path, what))
      violations.push_back({page.path, line,
                            what + " has " + std::to_string(count) + " words, at most " +
                                std::to_string(max) + " are read at once"});
  };
  int of_page = 0, of_section = 0, begin = 1;
  std::string heading = "what stands before the first heading";
  for (const Line& line : prose_of(page)) {
    if (is_heading(*line.text)) {
      report(begin, heading, of_section, max_section_words);
      heading = *line.text, begin = line.number, of_section = 0;
    }
    const int count = words_in(*line.text);
    of_page += count, of_section += count;
  }
  report(begin, heading, of_section, max_section_words);
  report(1, "the page", of_page, max_words);
}

}  // namespace

Violations broken_pages(const House& house, const Agreed& agreed) {
  Violations violations;
  Headings headings;
  for (const File& page : house.pages)
    for (const std::string& slug : slugs_of(page)) headings[page.path].insert(slug);
  Exceptions long_pages(agreed.long_pages);
  for (const File& page : house.pages) {
    report_links(page, house, headings, violations);
    const bool is_decision =
        page.path.starts_with("docs/decisions/") && page.path != decisions_page;
    report_length(page, is_decision ? max_decision_words : max_page_words, long_pages, violations);
  }
  long_pages.report_unused(violations);
  return violations;
}

}  // namespace prehend::architecture
