#include "tests/architecture/decisions.hpp"

#include <array>

namespace prehend::architecture {
namespace {

struct Part {
  std::string_view first;  // number of a record
  std::string_view heading;
};
constexpr std::array parts{Part{"0001", "Mapping and grasps"}, Part{"0050", "Recognition and DDS"},
                           Part{"0100", "The house, robots and tasks"}};

std::string_view part_of(std::string_view number) {
  std::string_view heading;
  for (const Part& part : parts)
    if (part.first <= number) heading = part.heading;
  return heading;
}

/// Without "# 0001:" before it.
std::string title_of(const File& page, std::string_view number) {
  const std::string& line = page.lines.front();
  const auto at = line.find(number);
  const auto begin = line.find_first_not_of(" :", at == std::string::npos ? 1 : at + number.size());
  return line.substr(std::min(line.size(), begin));
}

std::string state_of(const File& page) {
  for (const std::string_view word : {"Overtaken", "Changed"}) {
    const std::string begin = "**" + std::string(word) + ":**";
    for (auto line = page.lines.begin(); line != page.lines.end(); ++line) {
      if (!line->starts_with(begin)) continue;
      std::string text =
          (word == "Overtaken" ? "**no**:" : "in part:") + line->substr(begin.size());
      while (++line != page.lines.end() && !line->empty()) text += " " + *line;
      return text;
    }
  }
  return "yes";
}

}  // namespace

std::string decisions(const House& house) {
  std::string page =
      "# Decisions\n\n"
      "What was decided, why, and whether it holds. One record a decision, at most 250 words. Who "
      "changes what a\nrecord says adds a paragraph to it that begins with `**Changed:**`, or "
      "`**Overtaken:**` where nothing of it holds any more.\n"
      "`build/release/bin/draw_architecture --write` makes this page. A number that is missing was "
      "never used.\n";
  std::string_view open;
  for (const File& file : house.pages) {
    const std::string name = file.path.substr(file.path.rfind('/') + 1);
    if (folder_of(file.path) != "docs/decisions" || file.path == decisions_page ||
        file.lines.empty())
      continue;
    const std::string number = name.substr(0, 4);
    if (const std::string_view part = part_of(number); part != open) {
      page += "\n## " + std::string(part) + "\n| decision | holds |\n|---|---|\n";
      open = part;
    }
    page += "| [" + number + "](" + name + ") " + title_of(file, number) + " | " + state_of(file) +
            " |\n";
  }
  return page;
}

}  // namespace prehend::architecture
