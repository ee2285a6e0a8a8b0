#pragma once

#include "common/base/random.hpp"
#include "common/model/grasp_taxonomy.hpp"

namespace prehend::demonstration {

/// An object that people grasp in this way: of a shape and width that the taxonomy says, and as
/// long as such things are.
model::Shape drawn_object(const model::GraspClass& kind, Random& random);

/// The same as somebody measured it.
model::Shape measured(model::Shape shape, Random& random);

}  // namespace prehend::demonstration
