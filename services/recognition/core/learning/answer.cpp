#include "services/recognition/core/learning/answer.hpp"

#include <algorithm>

#include "common/base/named_values.hpp"

namespace prehend::recognition {
namespace {

/// Of pairs of colours in the mask and outside of it.
float likeness(const ObjectModels& models, const Plane& colours, const Plane& mask) {
  Plane outside = mask;
  for (auto& m : outside.values) m = m ? 0 : 1;
  const std::vector<Offset> offsets = offsets_at(models.distances);
  const auto pairs = [&](const Plane& region) {
    return descriptor(cooccurrence(colours, models.palette.size(), offsets, region), {},
                      Weighting::hellinger);
  };
  return pairs(mask).dot(pairs(outside));
}

}  // namespace

namespace {
constexpr auto verdict_names =
    named_values<PhotoVerdict>({{PhotoVerdict::object, "object"},
                                {PhotoVerdict::two_objects, "two objects"},
                                {PhotoVerdict::unknown, "unknown"},
                                {PhotoVerdict::nothing, "nothing"}});
}  // namespace

std::string_view to_string(PhotoVerdict verdict) {
  return verdict_names.name(verdict);
}

PhotoAnswer answer(const ObjectModels& models, const Picture& picture, double accept) {
  if (picture.width < 16 || picture.height < 16) return {};
  const Plane colours = models.palette.quantise(picture);
  const Plane middle = centred_mask(picture.width, picture.height);
  const auto seen_in = [&](int left, int top, int width, int height) {
    return classify(models, describe(models, crop(colours, left, top, width, height),
                                     centred_mask(width, height)));
  };
  const int w = picture.width, h = picture.height;
  const auto two = [&](const Classification& a, const Classification& b) {
    return a.best >= 0 && b.best >= 0 && a.best != b.best && a.probability >= accept &&
           b.probability >= accept;
  };
  const Classification left = seen_in(0, 0, w / 2, h), right = seen_in(w - w / 2, 0, w / 2, h);
  if (two(left, right))
    return {PhotoVerdict::two_objects, left.best, right.best,
            std::min(left.probability, right.probability)};
  const Classification top = seen_in(0, 0, w, h / 2), bottom = seen_in(0, h - h / 2, w, h / 2);
  if (two(top, bottom))
    return {PhotoVerdict::two_objects, top.best, bottom.best,
            std::min(top.probability, bottom.probability)};
  const Classification whole = classify(models, describe(models, colours, middle));
  if (whole.best >= 0 && whole.probability >= accept)
    return {PhotoVerdict::object, whole.best, -1, whole.probability};
  return {likeness(models, colours, middle) > 0.9f ? PhotoVerdict::nothing : PhotoVerdict::unknown,
          -1, -1, whole.probability};
}

}  // namespace prehend::recognition
