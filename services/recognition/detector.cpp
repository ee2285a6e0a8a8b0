#include "detector.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace prehend::recognition {
namespace {

/// The silhouette as a mask, without pixels that belong to another object.
Plane mask_of(const Silhouette& region, const Plane& taken) {
  Plane mask(taken.width, taken.height);
  for (std::size_t i = 0; i < region.rows.size(); ++i) {
    const int y = region.top + static_cast<int>(i);
    for (int x = region.rows[i].left; x < region.rows[i].right; ++x)
      mask.at(x, y) = taken.at(x, y) ? 0 : 1;
  }
  return mask;
}

/// The part of a plane in a box, so that work on a small region does not visit the whole picture.
Plane crop(const Plane& plane, int left, int top, int width, int height) {
  Plane made(width, height);
  for (int y = 0; y < height; ++y)
    std::copy_n(&plane.values[plane.index(left, top + y)], width, &made.values[made.index(0, y)]);
  return made;
}

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

/// What the outline adds to what the colours say. An object's shape and size are evidence of their
/// own: full agreement multiplies the odds by seven, 0.7 leaves them, 0.4 divides them by seven;
/// below 0.35 there is no such object.
double with_outline(double probability, double agreement) {
  if (agreement < 0.35) return 0;
  const double p = std::clamp(probability, 1e-9, 1 - 1e-9);
  const double odds = p / (1 - p) * std::exp(2 * (agreement - 0.7) / 0.3);
  return odds / (1 + odds);
}

}  // namespace

struct Detector::Hypothesis {
  int class_index = -1;
  Fit fit;
  double probability = 0;
  double rank = 0;
};

Detector::Detector(ObjectModels models, const model::Catalogue& catalogue, DetectorOptions options)
    : models_(std::move(models)), options_(std::move(options)) {
  for (const ObjectClass& c : models_.classes) {
    const model::CatalogueObject* known = catalogue.find(c.name);
    shapes_.push_back(known ? known->shape : model::Shape{});
  }
}

std::optional<Detector::Hypothesis> Detector::weigh(const Frame& frame, std::size_t c,
                                                    Fit fit) const {
  if (fit.region.area() < 60) return std::nullopt;
  const Bounds b = bounds(fit.region);
  const int w = b.right - b.left, h = b.bottom - b.top;
  const Plane mask = mask_of(fit.region, frame.taken);
  const Classification seen = classify(
      models_,
      describe(models_, crop(frame.colours, b.left, b.top, w, h), crop(mask, b.left, b.top, w, h)));
  if (seen.best < 0) return std::nullopt;
  Hypothesis made;
  made.class_index = static_cast<int>(c);
  made.rank = seen.similarity[static_cast<Eigen::Index>(c)] * static_cast<float>(fit.agreement);
  made.probability =
      seen.best == made.class_index ? with_outline(seen.probability, fit.agreement) : 0;
  made.fit = std::move(fit);
  return made;
}

Sighting Detector::sighting_of(const Hypothesis& hypothesis) const {
  const auto c = static_cast<std::size_t>(hypothesis.class_index);
  return {models_.classes[c].name,
          hypothesis.probability,
          to_box(bounds(hypothesis.fit.region)),
          shapes_[c],
          hypothesis.fit.at,
          hypothesis.fit.covariance};
}

std::optional<Detector::Hypothesis> Detector::examine(const Frame& frame, const CameraModel& camera,
                                                      const Votes& votes,
                                                      const Region& region) const {
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
  std::erase_if(classes, [&](const auto& c) { return c.first < 0.3f * classes.front().first; });

  std::optional<Hypothesis> best;
  for (const auto& [votes_of_class, c] : classes) {
    const model::Shape& shape = shapes_[c];
    const double middle = model::half_extents(shape).z();
    const auto place = camera.on_level(region.centre, middle);
    if (!place) continue;
    const auto& t = options_.table;
    if (place->x() < t[0] || place->x() > t[1] || place->y() < t[2] || place->y() > t[3]) continue;
    const double reach = std::clamp(model::half_extents(shape).maxCoeff(), 0.04, 0.08);
    const Eigen::VectorXf& colours = models_.classes[c].colours;
    auto fit = localise(frame, camera, shape, colours, place->x(), place->y(), reach);
    // The edge of what was searched is no maximum: look further from there.
    if (fit && std::hypot(fit->at.x - place->x(), fit->at.y - place->y()) > 0.75 * reach)
      fit = localise(frame, camera, shape, colours, fit->at.x, fit->at.y, reach);
    if (!fit) continue;
    auto hypothesis = weigh(frame, c, std::move(*fit));
    if (hypothesis && (!best || hypothesis->rank > best->rank)) best = std::move(hypothesis);
  }
  return best;
}

Expected<std::vector<Sighting>> Detector::on_table(const Picture& picture,
                                                   const CameraModel& camera) const {
  if (picture.width != camera.width || picture.height != camera.height)
    return fail(fmt::format("picture has {}x{} px, the calibration {}x{}", picture.width,
                            picture.height, camera.width, camera.height),
                "camera", "calibrate for this resolution or choose the camera's");
  Frame frame = prepare(picture, models_.palette);
  std::vector<Sighting> found;
  std::vector<double> agreements;  // of each found one's outline
  std::vector<Bounds> nothing;     // places that were examined in vain
  std::vector<Sighting> doubtful;
  // What is found is taken out of the picture, and the rest is scanned again: the windows around a
  // large object would outvote a small one.
  for (std::size_t before = 1; before != found.size();) {
    before = found.size();
    Votes votes = scan(models_, frame.colours, options_.scan, frame.taken);
    for (const Bounds& b : nothing) erase(votes, b.left, b.top, b.right, b.bottom);
    for (int tries = 0; tries < options_.most_tries;) {
      if (static_cast<int>(found.size()) >= options_.most_objects) break;
      const Region region = grow_strongest(votes);
      if (region.class_index < 0) break;
      const auto hypothesis = examine(frame, camera, votes, region);
      if (!hypothesis || hypothesis->probability < options_.accept) {
        if (hypothesis && hypothesis->probability >= options_.doubtful)
          doubtful.push_back(sighting_of(*hypothesis));
        nothing.push_back({region.left, region.top, region.right, region.bottom});
        erase(votes, region.left, region.top, region.right, region.bottom);
        ++tries;
        continue;
      }
      const auto c = static_cast<std::size_t>(hypothesis->class_index);
      const Bounds b = bounds(hypothesis->fit.region);
      const int halo = options_.scan.cell_size * options_.scan.windows.back() / 2;
      erase(votes, b.left - halo, b.top - halo, b.right + halo, b.bottom + halo);
      for (std::size_t i = 0; i < hypothesis->fit.region.rows.size(); ++i) {
        const auto& span = hypothesis->fit.region.rows[i];
        for (int x = span.left; x < span.right; ++x)
          frame.taken.at(x, hypothesis->fit.region.top + static_cast<int>(i)) = 1;
      }
      Sighting sighting = sighting_of(*hypothesis);
      // Two of a kind cannot stand in one place: the one whose outline agrees better is true.
      const double apart = model::half_extents(shapes_[c]).head<2>().norm();
      std::size_t same = 0;
      while (same < found.size() && (found[same].name != sighting.name ||
                                     std::hypot(found[same].at->x - sighting.at->x,
                                                found[same].at->y - sighting.at->y) > apart))
        ++same;
      if (same == found.size()) {
        found.push_back(std::move(sighting));
        agreements.push_back(hypothesis->fit.agreement);
      } else if (hypothesis->fit.agreement > agreements[same]) {
        found[same] = std::move(sighting);
        agreements[same] = hypothesis->fit.agreement;
      } else {
        ++tries;
      }
    }
  }
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
    return Sighting{models_.classes[c].name,
                    seen.probability,
                    {double(left), double(top), double(width), double(height)},
                    shapes_[c],
                    std::nullopt,
                    Eigen::Matrix3d::Zero()};
  };
  // One object in the middle, as in a photo of it.
  if (auto whole =
          look(0, 0, picture.width, picture.height, centred_mask(picture.width, picture.height))) {
    whole->box = {0.14 * picture.width, 0.14 * picture.height, 0.72 * picture.width,
                  0.72 * picture.height};
    found.push_back(*whole);
  }
  Votes votes = scan(models_, colours, options_.scan);
  for (int tries = 0; tries < 8 && static_cast<int>(found.size()) < options_.most_objects;
       ++tries) {
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
