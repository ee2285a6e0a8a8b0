#pragma once

#include "services/recognition/core/learning/object_models.hpp"

namespace prehend::recognition {

/// What is said of a photo as a whole. `unknown`: there is something, but none of the objects.
enum class PhotoVerdict { object, two_objects, unknown, nothing };
std::string_view to_string(PhotoVerdict verdict);

struct PhotoAnswer {
  PhotoVerdict verdict = PhotoVerdict::unknown;
  int first = -1, second = -1;  // classes, of `object` and `two_objects`
  double probability = 0;       // of the less sure one; of `unknown`, of the best guess
};

/// Looks at the middle, and at both halves, across and down: halves that are two different objects,
/// each at least `accept` sure, are two objects. What is not sure is nothing when pairs of colours
/// in the middle and around it are alike (Bhattacharyya coefficient above 0.9), else unknown.
PhotoAnswer answer(const ObjectModels& models, const Picture& picture, double accept = 0.5);

}  // namespace prehend::recognition
