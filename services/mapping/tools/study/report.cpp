#include "services/mapping/tools/study/report.hpp"

#include <fmt/format.h>

#include <fstream>
#include <system_error>

#include "common/base/base64.hpp"
#include "common/base/file_text.hpp"
#include "common/base/html.hpp"

namespace prehend::mapping {

namespace {

constexpr std::string_view head = R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>Prehend: the study</title><style>
body { font: 15px/1.45 sans-serif; max-width: 60em; margin: 2em auto; padding: 0 1em; color: #222; }
table { border-collapse: collapse; width: 100%; }
th, td { border-bottom: 1px solid #ccc; padding: .35em .5em; text-align: left; vertical-align: top; }
img { max-width: 100%; }
.reproduced { color: #176b2c; } .not { color: #a11c1c; } .undecided { color: #8a6100; }
</style></head><body>
)";

std::string_view style_of(Reproduction verdict) {
  switch (verdict) {
    case Reproduction::reproduced:
      return "reproduced";
    case Reproduction::not_reproduced:
      return "not";
    case Reproduction::undecided:
      break;
  }
  return "undecided";
}

std::string row(const Finding& finding) {
  return fmt::format(
      "<tr><td>{}</td><td>{}</td><td>{}</td><td class=\"{}\">{}</td><td>{}</td></tr>\n",
      html_escaped(finding.figure), html_escaped(finding.claim), html_escaped(finding.measured),
      style_of(finding.verdict), to_string(finding.verdict), html_escaped(finding.reason));
}

std::string benchmark_html(const std::vector<ModeSummary>& summaries) {
  if (summaries.empty()) return "";
  std::string text =
      "<h2>Grasp benchmark</h2>\n<p>Takes of people who were in no training set, answered by the "
      "very mapping of the live process in a simulated world; held: after being lifted and shaken. "
      "The same takes for all modes.</p>\n<table>\n";
  std::string_view cell = "th";
  for (const auto& row : to_rows(summaries)) {
    text += "<tr>";
    for (const std::string& value : row)
      text += fmt::format("<{0}>{1}</{0}>", cell, html_escaped(value));
    text += "</tr>\n";
    cell = "td";
  }
  return text + "</table>\n";
}

std::string html(const std::vector<Studied>& studied, const std::vector<ModeSummary>& summaries,
                 const StudyOptions& options, const std::vector<std::string>& pictures) {
  std::string text(head);
  text += fmt::format(
      "<h1>The thesis's experiments repeated</h1>\n<p>{} study, seed {}. Numbers in brackets are "
      "95 % confidence intervals. A claim is <b>reproduced</b> when the interval of what it says "
      "lies on its side of zero, <b>not reproduced</b> when it lies on the other side or too near "
      "to zero to matter, and <b>undecided</b> otherwise.</p>\n"
      "<table><tr><th>Figure</th><th>Claim</th><th>Measured</th><th>Verdict</th><th>Why</th></"
      "tr>\n",
      options.quick ? "Quick" : "Full", options.seed);
  for (const Studied& one : studied)
    for (const Finding& finding : one.outcome.findings) text += row(finding);
  text += "</table>\n" + benchmark_html(summaries);
  for (std::size_t i = 0; i < studied.size(); ++i) {
    const Experiment& experiment = *studied[i].experiment;
    text += fmt::format(
        "<h2>{}: {}</h2>\n<p>{}. {} repetitions, each with another person and other first weights."
        "</p>\n<img alt=\"{}\" src=\"data:image/png;base64,{}\">\n",
        html_escaped(experiment.figure), html_escaped(experiment.title),
        html_escaped(experiment.method), studied[i].table.values.rows(),
        html_escaped(experiment.title), base64(pictures[i]));
  }
  return text + "</body></html>\n";
}

Expected<void> write(const std::filesystem::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) return fail("cannot be written", file.string());
  return {};
}

}  // namespace

Expected<void> write_report(const std::filesystem::path& folder,
                            const std::vector<Studied>& studied,
                            const std::vector<TrialResult>& trials, const StudyOptions& options) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return fail(error.message(), folder.string());
  std::vector<std::string> pictures;
  for (const Studied& one : studied) {
    const std::string& figure = one.experiment->figure;
    if (auto ok = write(folder / (figure + ".csv"), to_csv(one.outcome.chart)); !ok) return ok;
    if (auto ok = write(folder / (figure + "-repetitions.csv"), to_csv(one.table)); !ok) return ok;
    const auto png = folder / (figure + ".png");
    if (auto ok = draw(one.outcome.chart, png); !ok) return ok;
    auto picture = read_file(png);
    if (!picture) return tl::unexpected(picture.error());
    pictures.push_back(std::move(*picture));
  }
  if (!trials.empty())
    if (auto ok = write(folder / "benchmark.csv", to_csv(trials)); !ok) return ok;
  return write(folder / "report.html", html(studied, summarise(trials), options, pictures));
}

std::string to_markdown(const std::vector<Studied>& studied,
                        const std::vector<ModeSummary>& summaries) {
  std::string text;
  if (!studied.empty())
    text += "| figure | claim | measured | verdict | why |\n|---|---|---|---|---|\n";
  for (const Studied& one : studied)
    for (const Finding& finding : one.outcome.findings)
      text += fmt::format("| {} | {} | {} | {} | {} |\n", finding.figure, finding.claim,
                          finding.measured, to_string(finding.verdict), finding.reason);
  if (summaries.empty()) return text;
  if (!studied.empty()) text += "\n";
  return text + to_table(summaries);
}

}  // namespace prehend::mapping
