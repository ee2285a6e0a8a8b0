#pragma once

#include "common/base/random.hpp"
#include "services/recognition/core/learning/object_models.hpp"

namespace prehend::recognition {

/// A picture of one object. The mask tells which pixels show it.
struct TrainingView {
  Picture picture;
  Plane mask;
};
struct TrainingClass {
  std::string name;
  std::vector<TrainingView> views;
};

/// Learns palette, views and classifier. Views without a picture are skipped; fails without any
/// class that has a view. More than `max_views` views of a class are thinned out evenly. `others`
/// are things that are none of the classes, as many and as different as there are: what is like
/// them is told from the objects, and how sure an answer is, is measured on them, too.
Expected<ObjectModels> train(const std::vector<TrainingClass>& classes,
                             const DescriptorOptions& options = {}, int max_views = 60,
                             const std::vector<TrainingClass>& others = {});

/// The same models and one class more, in a second: palette and weights stay as they were learned,
/// the classifier and its calibration are made anew. Fails when the class is known or has no usable
/// view. (An object of colours that the palette lacks is better learned together with the others.)
Expected<ObjectModels> with_class(ObjectModels models, const TrainingClass& added,
                                  const DescriptorOptions& options = {}, int max_views = 60);

/// The picture as another day might show it: brighter or darker, in light of another colour, nearer
/// or further, not quite in the middle. The mask stays.
Picture varied(const Picture& picture, Random& random);

/// What is left of a mask when something stands before 20 to 45 % of it: a straight edge through it
/// in any direction.
Plane part_of(const Plane& mask, Random& random);

}  // namespace prehend::recognition
