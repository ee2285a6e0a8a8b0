#include "tests/architecture/decisions.hpp"

namespace prehend::architecture {
namespace {

/// Without "# 0001:" before it.
std::string title_of(const File& page) {
  const std::string& line = page.lines.front();
  return line.substr(std::min(line.size(), line.find_first_not_of("# :0123456789")));
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
      "`build/release/bin/draw_architecture --write` makes this page. Numbers: 0001 to 0049 "
      "mapping "
      "and grasps, 0050 to 0099\nrecognition and DDS, from 0100 the house, robots and tasks.\n\n"
      "| decision | holds |\n|---|---|\n";
  for (const File& file : house.pages) {
    const std::string name = file.path.substr(file.path.rfind('/') + 1);
    if (folder_of(file.path) != "docs/decisions" || file.path == decisions_page ||
        file.lines.empty())
      continue;
    page += "| [" + name.substr(0, 4) + "](" + name + ") " + title_of(file) + " | " +
            state_of(file) + " |\n";
  }
  return page;
}

}  // namespace prehend::architecture
