#include "services/recognition/tools/evaluation/report.hpp"

#include <fmt/format.h>

#include <fstream>

#include "common/base/base64.hpp"
#include "common/base/gnuplot.hpp"
#include "common/base/html.hpp"
#include "common/statistics/intervals.hpp"
#include "services/recognition/files/picture_file.hpp"

namespace prehend::recognition {
namespace {

constexpr int thumbnail_side = 220;  // px

std::string name_of(const std::vector<std::string>& classes, int index, const char* none) {
  return index < 0 ? none : html_escaped(classes[static_cast<std::size_t>(index)]);
}

std::string table(const std::vector<std::string>& classes, std::span<const Judged> pictures) {
  const auto counts = confusion(pictures, classes.size());
  std::string made = "<table><tr><th>is \\ taken for</th>";
  for (std::size_t i = 0; i < classes.size(); ++i) made += fmt::format("<th>{}</th>", i + 1);
  made += "</tr>\n";
  for (std::size_t row = 0; row < classes.size(); ++row) {
    made += fmt::format("<tr><th>{} {}</th>", row + 1, html_escaped(classes[row]));
    for (std::size_t column = 0; column < classes.size(); ++column) {
      const int count = counts[row][column];
      made += fmt::format("<td{}>{}</td>",
                          count == 0      ? ""
                          : row == column ? " class=right"
                                          : " class=wrong",
                          count == 0 ? std::string() : std::to_string(count));
    }
    made += "</tr>\n";
  }
  return made + "</table>\n";
}

}  // namespace

Expected<void> draw_reliability(const std::filesystem::path& png, const std::string& title,
                                std::span<const Judged> pictures) {
  std::string data = "$bins << EOD\n";
  for (const Bin& bin : reliability(pictures)) {
    if (bin.count == 0) continue;
    const auto right = static_cast<std::size_t>(bin.held * static_cast<double>(bin.count) + 0.5);
    const statistics::Interval range = statistics::share_interval(right, bin.count);
    data += fmt::format("{:.4f} {:.4f} {:.4f} {:.4f} {}\n", bin.said, bin.held, range.low,
                        range.high, bin.count);
  }
  std::string plain;  // gnuplot's own marks are left out of the title
  for (const char c : title)
    if (c != '\'' && c != '\n') plain += c;
  return draw_by_gnuplot(
      data + "EOD\n" + fmt::format("set title '{}' noenhanced\n", plain) +
          "set xlabel 'probability that was said'\nset ylabel 'share that was right'\n"
          "set xrange [0:1]\nset yrange [0:1.05]\nset key left top\nset grid\n"
          "plot x with lines lc rgb '#999999' dt 2 title 'perfect', "
          "$bins using 1:2:3:4 with yerrorbars pt 7 lc rgb '#2060a0' title 'measured (95 %)', "
          "$bins using 1:2 with lines lc rgb '#2060a0' notitle, "
          "$bins using 1:($2-0.05):5 with labels font 'Sans,8' notitle\n",
      png, 640, 480);
}

Expected<void> write_report(const std::filesystem::path& folder, const std::string& title,
                            const std::vector<std::string>& classes,
                            std::span<const Judged> pictures, double threshold) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return fail(error.message(), folder.string(), "is the place writable?");
  const auto drawn = draw_reliability(folder / "reliability.png", title, pictures);
  std::ofstream page(folder / "index.html");
  page << "<!doctype html>\n<meta charset=utf-8>\n<title>" << html_escaped(title) << "</title>\n"
       << "<style>body{font-family:sans-serif;margin:2em}td{text-align:center;min-width:2em}"
          "th{text-align:left}.right{background:#cfe8cf}.wrong{background:#f0c0c0}"
          "figure{display:inline-block;margin:.5em;width:220px;vertical-align:top}"
          "figcaption{font-size:80%}</style>\n"
       << "<h1>" << html_escaped(title) << "</h1>\n"
       << table(classes, pictures);
  if (drawn)
    page << "<h2>Reliability</h2>\n<img src=reliability.png alt=\"reliability diagram\">\n";
  else
    page << "<p>No reliability diagram: " << html_escaped(drawn.error().message()) << "</p>\n";
  page << "<h2>Failures</h2>\n";
  std::size_t failures = 0;
  for (const Judged& picture : pictures) {
    const bool stranger = picture.truth < 0;
    if (stranger ? picture.probability < threshold || picture.best < 0 : picture.right()) continue;
    ++failures;
    const auto shown = load_picture(picture.file);
    page << "<figure>";
    if (shown)
      page << "<img alt=\"\" src=\"data:image/jpeg;base64,"
           << base64(encode_jpeg(shrink(*shown, thumbnail_side), 80)) << "\">";
    page << "<figcaption>" << html_escaped(picture.file.filename().string()) << "<br>"
         << name_of(classes, picture.truth, "a stranger") << " taken for "
         << name_of(classes, picture.best, "nothing")
         << fmt::format(", {:.0f} % sure</figcaption></figure>\n", 100 * picture.probability);
  }
  if (failures == 0) page << "<p>None.</p>\n";
  page.flush();
  if (!page)
    return fail("cannot be written", (folder / "index.html").string(), "is the place writable?");
  return {};
}

}  // namespace prehend::recognition
