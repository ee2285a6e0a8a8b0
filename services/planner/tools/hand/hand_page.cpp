#include "services/planner/tools/hand/hand_page.hpp"

#include <fmt/format.h>

#include <cctype>

#include "common/base/file_text.hpp"
#include "common/base/html.hpp"
#include "services/planner/tools/picture/grasp_picture.hpp"

namespace prehend::planner {
namespace {

constexpr int width = 560, height = 420;
constexpr double aspect = static_cast<double>(width) / height;
constexpr const char* place = "pictures";

/// A name for a file: letters, digits, and _ for all else.
std::string file_named(const std::string& text) {
  std::string name;
  for (const char c : text) name += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return name.substr(0, 60) + ".png";
}

/// Pictures in the folder, and the HTML that shows them.
class Album {
 public:
  explicit Album(std::filesystem::path folder) : folder_(std::move(folder)) {}

  Expected<void> add(const std::string& title, const Raster& raster) {
    const std::string file = file_named(title);
    if (auto saved = save(folder_ / place / file, raster); !saved) return saved;
    html_ += fmt::format(
        "<figure><img alt=\"{0}\" src=\"{1}/{2}\"><figcaption>{0}</figcaption></figure>\n",
        html_escaped(title), place, file);
    return {};
  }
  const std::string& html() const { return html_; }

 private:
  std::filesystem::path folder_;
  std::string html_;
};

Expected<void> draw_postures(Album& album, const model::HandModel& hand) {
  // From before the palm, a little from the side and from above.
  const Eigen::Vector3d from = Eigen::Vector3d(0.75, 0.5, 0.45).normalized();
  for (const auto& [name, dof] : hand.postures()) {
    const Drawing drawing = draw_hand(hand, dof);
    const Viewpoint view = look_at(drawing, from, aspect);
    if (auto added = album.add(name, drawing.draw(view, width, height, 2)); !added) return added;
  }
  return {};
}

Expected<void> draw_trials(Album& album, const model::HandModel& hand,
                           const std::vector<Trial>& trials) {
  for (const Trial& trial : trials) {
    if (!trial.best) continue;
    const auto scene = draw_grasp(hand, trial.object, *trial.best);
    if (!scene) return tl::unexpected(scene.error());
    const Raster raster = scene->drawing.draw(best_view(*scene, aspect), width, height, 2);
    const std::string title = trial.object.name + (trial.best->hold.held ? ": held" : ": not held");
    if (auto added = album.add(title, raster); !added) return added;
  }
  return {};
}

std::string list_of(const nlohmann::ordered_json& report) {
  std::string text =
      "<table><tr><th>degree of freedom</th><th>closes towards</th><th>from</th><th>to</th></tr>\n";
  for (const auto& dof : report["dofs"]) {
    const int closing = dof["closing"].get<int>();
    text += fmt::format("<tr><td>{}</td><td>{}</td><td>{:.3g}</td><td>{:.3g}</td></tr>\n",
                        html_escaped(dof["name"].get<std::string>()),
                        closing == 0  ? "–"
                        : closing > 0 ? "its upper limit"
                                      : "its lower limit",
                        dof["lower"].get<double>(), dof["upper"].get<double>());
  }
  text += "</table>\n<h2>What was found and changed</h2>\n<ul>\n";
  for (const auto& finding : report["findings"])
    text += fmt::format("<li>{}: {}</li>\n", html_escaped(finding["element"].get<std::string>()),
                        html_escaped(finding["what"].get<std::string>()));
  for (const auto& change : report["changes"])
    text += fmt::format("<li>{}</li>\n", html_escaped(change.get<std::string>()));
  return text + "</ul>\n";
}

}  // namespace

Expected<void> write_page(const std::filesystem::path& folder, const model::HandModel& hand,
                          const std::vector<Trial>& trials, const nlohmann::ordered_json& report) {
  std::error_code failed;
  std::filesystem::create_directories(folder / place, failed);
  Album postures(folder), grasps(folder);
  if (auto drawn = draw_postures(postures, hand); !drawn) return drawn;
  if (auto drawn = draw_trials(grasps, hand, trials); !drawn) return drawn;
  const std::string name = html_escaped(report["name"].get<std::string>());
  const std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{0}</title><style>"
      "body{{font:16px sans-serif;max-width:75em;margin:2em auto;padding:0 1em}}"
      "figure{{display:inline-block;margin:.5em;text-align:center}}img{{max-width:18em}}"
      "td,th{{padding:.1em .8em;text-align:left}}</style></head><body>\n<h1>{0}</h1>\n"
      "<p>{1} fingertips, {2} degrees of freedom; takes objects up to {3:.0f} mm.</p>\n"
      "<h2>Postures</h2>\n{4}<h2>Grasps that were tried</h2>\n{5}<h2>Degrees of freedom</h2>\n{6}"
      "</body></html>\n",
      name, report["fingertips"].size(), report["dofs"].size(),
      1e3 * report["opening_m"].get<double>(), postures.html(), grasps.html(), list_of(report));
  return write_file(folder / "hand.html", html);
}

}  // namespace prehend::planner
