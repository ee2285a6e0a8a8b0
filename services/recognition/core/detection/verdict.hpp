#pragma once

#include <Eigen/Core>

namespace prehend::recognition {

/// What is known of something that was measured as an object.
struct Signs {
  double by_colours = 0;               // probability that its colours alone give
  double agreement = 0, contrast = 0;  // of its outline
  Eigen::Vector2d measured = {1, 1};   // width and height as shares of the catalogue's
  double hidden = 0;                   // share of it that something stands before
};

/// The numbers that the verdict weighs: 1, log odds of the colours, agreement, contrast, size (how
/// far it is from the catalogue's, in squares of 8 %, at most 10) and what is hidden.
using SignRow = Eigen::Matrix<double, 6, 1>;
SignRow row(const Signs& signs);

/// Such an outline is of no object, whatever the colours: it agrees or shows too little.
bool shapeless(const Signs& signs);

/// The probability that colours and outline together give; 0 for what is shapeless. An object's
/// shape and size are evidence of their own: objects measure as the catalogue says, within 5 %;
/// what is mistaken for one does not. What is hidden tells nothing, and a stranger of which the
/// strange part is taken for hidden looks like the rest of an object: the more is hidden, the less
/// is believed.
double verdict(const Signs& signs);

}  // namespace prehend::recognition
