#include "services/recognition/core/detection/detector.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "services/recognition/core/detection/verdict.hpp"

namespace prehend::recognition {
namespace {

struct Bounds {
  int left = 0, top = 0, right = 0, bottom = 0;
};

Bounds bounds(const Silhouette& region) {
  Bounds b{1 << 20, region.top, 0, region.top + static_cast<int>(region.rows.size())};
  for (const auto& span : region.rows) {
    if (span.right <= span.left) continue;
    b.left = std::min(b.left, span.left);
    b.right = std::max(b.right, span.right);
  }
  return b;
}

Box to_box(const Bounds& b) {
  return {double(b.left), double(b.top), double(b.right - b.left), double(b.bottom - b.top)};
}

}  // namespace

/// Where a class was looked for, or found.
struct Detector::Tried {
  std::size_t class_index = 0;
  Eigen::Vector2d at;  // x, y in W, m
};

struct Detector::Hypothesis {
  int class_index = -1;
  Fit fit;
  double probability = 0, by_colours = 0;
  double rank = 0;
};

Detector::Detector(ObjectModels models, const model::Catalogue& catalogue, DetectorOptions options)
    : models_(std::move(models)), options_(std::move(options)) {
  for (const ObjectClass& c : models_.classes) {
    const model::CatalogueObject* known = catalogue.find(c.name);
    shapes_.push_back(known ? known->shape : model::Shape{});
  }
}

std::optional<Detector::Hypothesis> Detector::measure(const FittingImage& frame,
                                                      const CameraModel& camera, std::size_t c,
                                                      double x, double y, double reach) const {
  const Eigen::VectorXf& colours = models_.classes[c].colours;
  auto fit = localise(frame, camera, shapes_[c], colours, x, y, reach);
  // The edge of what was searched is no maximum: look further from there.
  if (fit && std::hypot(fit->at.x - x, fit->at.y - y) > 0.75 * reach)
    fit = localise(frame, camera, shapes_[c], colours, fit->at.x, fit->at.y, reach);
  return fit ? weigh(frame, c, std::move(*fit)) : std::nullopt;
}

std::optional<Detector::Hypothesis> Detector::weigh(const FittingImage& frame, std::size_t c,
                                                    Fit fit) const {
  if (fit.region.area() < 60) return std::nullopt;
  const Bounds b = bounds(fit.region);
  const int w = b.right - b.left, h = b.bottom - b.top;
  const Classification seen =
      classify(models_, describe(models_, crop(frame.colours, b.left, b.top, w, h),
                                 crop(fit.visible, b.left, b.top, w, h)));
  if (seen.best < 0) return std::nullopt;
  Hypothesis made;
  made.class_index = static_cast<int>(c);
  made.rank = seen.similarity[static_cast<Eigen::Index>(c)] * static_cast<float>(fit.agreement);
  made.by_colours = seen.best == made.class_index ? seen.probability : 0;
  if (made.by_colours > 0)
    made.probability =
        verdict({made.by_colours, fit.agreement, fit.contrast, fit.measured, fit.hidden});
  made.fit = std::move(fit);
  return made;
}

Sighting Detector::sighting_of(const Hypothesis& hypothesis) const {
  const auto c = static_cast<std::size_t>(hypothesis.class_index);
  return {.class_index = hypothesis.class_index,
          .name = models_.classes[c].name,
          .probability = hypothesis.probability,
          .by_colours = hypothesis.by_colours,
          .box = to_box(bounds(hypothesis.fit.region)),
          .shape = shapes_[c],
          .at = hypothesis.fit.at,
          .covariance = hypothesis.fit.covariance,
          .agreement = hypothesis.fit.agreement,
          .measured = hypothesis.fit.measured,
          .contrast = hypothesis.fit.contrast,
          .hidden = hypothesis.fit.hidden,
          .region = hypothesis.fit.region};
}

std::optional<Detector::Hypothesis> Detector::examine(const FittingImage& frame,
                                                      const CameraModel& camera, const Votes& votes,
                                                      const Region& region,
                                                      std::vector<Tried>& tried) const {
  // The classes with most votes in the region.
  std::vector<std::pair<float, std::size_t>> classes;
  for (std::size_t c = 0; c < votes.classes.size(); ++c) {
    float sum = 0;
    for (const Eigen::Vector2i& cell : region.cells) sum += votes.classes[c](cell.y(), cell.x());
    if (sum > 0 && model::is_valid(shapes_[c])) classes.push_back({sum, c});
  }
  std::sort(classes.rbegin(), classes.rend());
  if (static_cast<int>(classes.size()) > options_.hypotheses)
    classes.resize(static_cast<std::size_t>(options_.hypotheses));
  std::erase_if(classes, [&](const auto& c) { return c.first < 0.2f * classes.front().first; });

  // What is accepted comes before what is only more alike.
  const auto better = [&](const Hypothesis& a, const Hypothesis& b) {
    const bool a_true = a.probability >= options_.accept, b_true = b.probability >= options_.accept;
    return a_true != b_true ? a_true : a.rank > b.rank;
  };
  std::optional<Hypothesis> best;
  for (const auto& [votes_of_class, c] : classes) {
    const model::Shape& shape = shapes_[c];
    const double middle = model::half_extents(shape).z();
    const auto place = camera.on_level(region.centre, middle);
    if (!place) continue;
    const auto& t = options_.table;
    if (place->x() < t[0] || place->x() > t[1] || place->y() < t[2] || place->y() > t[3]) continue;
    const double reach = std::clamp(model::half_extents(shape).maxCoeff(), 0.04, 0.08);
    // A start near another, or near what was found from there, finds the same outline again.
    const bool again = std::any_of(tried.begin(), tried.end(), [&, c = c](const Tried& before) {
      return before.class_index == c && (before.at - place->head<2>()).norm() < 0.75 * reach;
    });
    if (again) continue;
    tried.push_back({c, place->head<2>()});
    auto hypothesis = measure(frame, camera, c, place->x(), place->y(), reach);
    if (hypothesis) tried.push_back({c, {hypothesis->fit.at.x, hypothesis->fit.at.y}});
    if (hypothesis && (!best || better(*hypothesis, *best))) best = std::move(hypothesis);
  }
  return best;
}

int Detector::search(FittingImage& frame, const CameraModel& camera, Plane& open, int most,
                     std::vector<Sighting>& found, std::vector<Sighting>* doubtful) const {
  const std::size_t known_before = found.size();
  int examined = 0;
  for (const Sighting& known : found) known.region.mark(frame.taken, 1);
  std::vector<Bounds> nothing;  // places that were examined in vain
  // What is found is taken out of the picture, and the rest is scanned again: the windows around a
  // large object would outvote a small one.
  for (std::size_t before = found.size() + 1; before != found.size();) {
    before = found.size();
    Votes votes = scan(models_, frame.colours, options_.scan, frame.taken);
    for (const Bounds& b : nothing) erase(votes, b.left, b.top, b.right, b.bottom);
    std::vector<Tried> tried;
    for (int tries = 0; tries < options_.max_tries;) {
      if (static_cast<int>(found.size()) >= options_.max_objects) break;
      const Region region = grow_strongest(votes, open);
      if (region.class_index < 0) break;
      if (examined == most) return examined;
      const std::size_t measured = tried.size();
      const auto hypothesis = examine(frame, camera, votes, region, tried);
      const bool looked = tried.size() > measured;
      examined += looked;
      if (!hypothesis || hypothesis->probability < options_.accept) {
        if (doubtful && hypothesis && hypothesis->probability >= options_.doubtful)
          doubtful->push_back(sighting_of(*hypothesis));
        nothing.push_back({region.left, region.top, region.right, region.bottom});
        erase(votes, region.left, region.top, region.right, region.bottom);
        for (const Eigen::Vector2i& cell : region.cells)
          if (cell.x() < open.width && cell.y() < open.height) open.at(cell.x(), cell.y()) = 0;
        tries += looked;
        continue;
      }
      Sighting sighting = sighting_of(*hypothesis);
      const int halo = options_.scan.cell_size * options_.scan.windows.back() / 2;
      const Bounds b = bounds(sighting.region);
      erase(votes, b.left - halo, b.top - halo, b.right + halo, b.bottom + halo);
      sighting.region.mark(frame.taken, 1);
      // Two of a kind cannot stand in one place: the one whose outline agrees better is true.
      const double apart = model::half_extents(sighting.shape).head<2>().norm();
      const auto fresh = found.begin() + static_cast<std::ptrdiff_t>(known_before);
      const auto same = std::find_if(found.begin(), found.end(), [&](const Sighting& other) {
        return other.name == sighting.name &&
               std::hypot(other.at->x - sighting.at->x, other.at->y - sighting.at->y) <= apart;
      });
      if (same == found.end())
        found.push_back(std::move(sighting));
      else if (same >= fresh && sighting.agreement > same->agreement)
        *same = std::move(sighting);
      else
        ++tries;
    }
  }
  std::fill(open.values.begin(), open.values.end(), std::uint8_t{0});
  return examined;
}

std::optional<Sighting> Detector::judge(const FittingImage& frame, const CameraModel& camera,
                                        std::size_t c, double x, double y) const {
  const auto hypothesis = measure(frame, camera, c, x, y, 0.04);
  return hypothesis ? std::optional(sighting_of(*hypothesis)) : std::nullopt;
}

std::optional<Sighting> Detector::follow(const FittingImage& frame, const CameraModel& camera,
                                         const Sighting& before) const {
  auto seen = judge(frame, camera, static_cast<std::size_t>(before.class_index), before.at->x,
                    before.at->y);
  if (!seen || seen->probability < options_.accept) return std::nullopt;
  return seen;
}

Expected<std::vector<Sighting>> Detector::on_table(const Picture& picture,
                                                   const CameraModel& camera) const {
  if (picture.width != camera.width || picture.height != camera.height)
    return fail(fmt::format("picture has {}x{} px, the calibration {}x{}", picture.width,
                            picture.height, camera.width, camera.height),
                "camera", "calibrate for this resolution or choose the camera's");
  FittingImage frame = prepare(picture);
  const int cell = options_.scan.cell_size;
  Plane open(picture.width / cell + 1, picture.height / cell + 1, 1);
  std::vector<Sighting> found, doubtful;
  search(frame, camera, open, std::numeric_limits<int>::max(), found, &doubtful);
  found.insert(found.end(), doubtful.begin(), doubtful.end());
  return found;
}

std::vector<Sighting> Detector::in_picture(const Picture& picture) const {
  std::vector<Sighting> found;
  if (picture.width < 8 || picture.height < 8) return found;
  const Plane colours = models_.palette.quantise(picture);
  const auto look = [&](int left, int top, int width, int height,
                        const Plane& mask) -> std::optional<Sighting> {
    const Classification seen =
        classify(models_, describe(models_, crop(colours, left, top, width, height), mask));
    if (seen.best < 0 || seen.probability < options_.accept) return std::nullopt;
    const auto c = static_cast<std::size_t>(seen.best);
    return Sighting{.class_index = seen.best,
                    .name = models_.classes[c].name,
                    .probability = seen.probability,
                    .box = {double(left), double(top), double(width), double(height)},
                    .shape = shapes_[c]};
  };
  // One object in the middle, as in a photo of it.
  if (auto whole =
          look(0, 0, picture.width, picture.height, centred_mask(picture.width, picture.height))) {
    whole->box = {0.14 * picture.width, 0.14 * picture.height, 0.72 * picture.width,
                  0.72 * picture.height};
    found.push_back(*whole);
  }
  Votes votes = scan(models_, colours, options_.scan);
  for (int tries = 0; tries < 8 && static_cast<int>(found.size()) < options_.max_objects; ++tries) {
    const Region region = grow_strongest(votes);
    if (region.class_index < 0) break;
    erase(votes, region.left, region.top, region.right, region.bottom);
    const int width = std::min(region.right, picture.width) - region.left;
    const int height = std::min(region.bottom, picture.height) - region.top;
    if (width < 16 || height < 16) continue;
    Plane mask(width, height);
    for (const Eigen::Vector2i& cell : region.cells)
      for (int y = 0; y < votes.cell_size; ++y)
        for (int x = 0; x < votes.cell_size; ++x) {
          const int px = cell.x() * votes.cell_size + x - region.left;
          const int py = cell.y() * votes.cell_size + y - region.top;
          if (px < width && py < height) mask.at(px, py) = 1;
        }
    const auto sighting = look(region.left, region.top, width, height, mask);
    if (!sighting) continue;
    const bool known = std::any_of(found.begin(), found.end(), [&](const Sighting& other) {
      return other.name == sighting->name;  // the same one, seen twice
    });
    if (!known) found.push_back(*sighting);
  }
  std::sort(found.begin(), found.end(),
            [](const Sighting& a, const Sighting& b) { return a.probability > b.probability; });
  return found;
}

}  // namespace prehend::recognition
