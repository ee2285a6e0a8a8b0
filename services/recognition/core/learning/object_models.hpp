#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "services/recognition/core/descriptor/cooccurrence.hpp"
#include "services/recognition/core/descriptor/palette.hpp"
#include "services/recognition/core/learning/calibration.hpp"

namespace prehend::recognition {

/// How two histograms are compared; all give 0..1, 1 for equal ones.
enum class Weighting {
  idf_hellinger,  // square roots of the shares, weighted by rarity, as unit vectors: their dot
                  // product
  hellinger,      // the same without weights: the Bhattacharyya coefficient
  intersection,   // the sum of the smaller shares (Swain and Ballard 1991; Chang and Krumm 1999)
};

/// What a picture is turned into before it is compared. All is stored in the model, so a model is
/// always used as it was made. The defaults are for objects cut out by masks, which are looked for
/// on a table; photos_of_objects() did best on photos of single objects (README.md has the table).
struct DescriptorOptions {
  ColourSpace space;                           // in which the palette is made
  int colours = 64;                            // of the palette, at most Palette::max_colours
  int coarse_colours = 20;                     // of the scan's palette, merged from the fine one
  std::vector<int> distances = {1, 3, 6, 10};  // px between the pixels of a pair, four directions
  double same_pairs = 1;                       // weight of pairs of one colour, 0..1
  Weighting weighting = Weighting::idf_hellinger;  // how histograms are compared
  int varied = 0;          // copies of each view under another light, size and place
  int parts = 1;           // copies of each view of which a part is hidden
  int views_a_class = 6;   // prototypes that the scan compares with
  std::uint64_t seed = 1;  // of the palette and of varied copies
};
DescriptorOptions photos_of_objects();

/// Folds by background in which a classification's doubt is measured.
inline constexpr int calibration_folds = 5;

struct ObjectClass {
  std::string name;
  Eigen::VectorXf colours;     // share of each palette colour, sums to 1
  Eigen::MatrixXf prototypes;  // square roots of coarse histograms, one a column, of norm 1
};

/// Everything that training yields. Plain data; `check` tells whether it fits together.
struct ObjectModels {
  Palette palette;
  std::vector<int> coarse;  // coarse colour of each colour of the palette
  int coarse_colours = 0;
  std::vector<int> distances;
  double same_pairs = 1;
  Weighting weighting = Weighting::idf_hellinger;
  Eigen::VectorXf idf;  // weight of each pair of colours
  std::vector<ObjectClass> classes;
  Eigen::MatrixXf views;        // descriptors of all training views, one a column
  std::vector<int> view_class;  // of each column; -1: of something that is none of the classes
  std::vector<int> view_fold;   // by background, 0 to calibration_folds - 1
  Eigen::MatrixXf dual;         // views by classes: the kernel ridge classifier
  double kernel_sharpness = 0;  // k(a, b) = exp(sharpness (similarity(a, b) - 1))
  Calibration calibration;

  Expected<void> check() const;
};

/// What a region was taken for.
struct Classification {
  Eigen::VectorXf scores;      // of each class
  Eigen::VectorXf similarity;  // of each class' nearest view, 0..1
  int best = -1;               // index of the class; -1 without any
  double probability = 0;      // that `best` is right
};

/// Counts of pairs as a descriptor: unit vectors whose dot product is the similarity or, for the
/// intersection, shares. Zero for empty counts.
Eigen::VectorXf descriptor(const Eigen::VectorXf& counts, const Eigen::VectorXf& idf,
                           Weighting weighting = Weighting::idf_hellinger);
/// Similarities of the columns of `views` and those of `others`.
Eigen::MatrixXf similarities(const Eigen::MatrixXf& views, const Eigen::MatrixXf& others,
                             Weighting weighting);

/// Pixels in an upright ellipse around the middle: where the object is in a photo of one object.
Plane centred_mask(int width, int height);

/// Compares a descriptor with all classes, by the learned classifier or the nearest view.
Classification classify(const ObjectModels& models, const Eigen::VectorXf& descriptor,
                        bool learned = true);

/// Descriptor of a masked region of a quantised picture.
Eigen::VectorXf describe(const ObjectModels& models, const Plane& colours, const Plane& mask);

}  // namespace prehend::recognition
