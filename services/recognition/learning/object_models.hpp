#pragma once

#include <cstdint>
#include <prehend/base/error.hpp>
#include <prehend/recognition_descriptor/cooccurrence.hpp>
#include <prehend/recognition_descriptor/palette.hpp>
#include <string>
#include <vector>

namespace prehend::recognition {

/// What a picture is turned into before it is compared. The defaults are what did best on photos
/// and rendered views alike; all is stored in the model, so a model is always used as it was made.
struct DescriptorOptions {
  ColourSpace space;
  int colours = 64;                            // of the palette, at most Palette::max_colours
  int coarse_colours = 20;                     // of the scan's palette, merged from the fine one
  std::vector<int> distances = {1, 3, 6, 10};  // px between the pixels of a pair, four directions
  int views_a_class = 6;                       // prototypes that the scan compares with
  std::uint64_t seed = 1;
};

/// A picture of one object. The mask tells which pixels show it.
struct TrainingView {
  Picture picture;
  Plane mask;
};
struct TrainingClass {
  std::string name;
  std::vector<TrainingView> views;
};

/// How sure a classification is: P(right) = 1 / (1 + exp(-(w . (1, score, margin, similarity)))),
/// fitted on views that the classifier had not seen and on views of classes left out.
struct Calibration {
  Eigen::Vector4d w = Eigen::Vector4d::Zero();
  double probability(double score, double margin, double similarity) const;
};

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
  Eigen::VectorXf idf;  // weight of each pair of colours
  std::vector<ObjectClass> classes;
  Eigen::MatrixXf views;        // descriptors of all training views, one a column, of norm 1
  std::vector<int> view_class;  // of each column
  Eigen::MatrixXf dual;         // views by classes: the kernel ridge classifier
  double kernel_sharpness = 0;  // k(a, b) = exp(sharpness (a . b - 1))
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

/// Weighted Hellinger descriptor: square root of the normalised counts, weighted by rarity, of norm
/// 1, so that the dot product of two is their similarity. Zero for empty counts.
Eigen::VectorXf descriptor(const Eigen::VectorXf& counts, const Eigen::VectorXf& idf);

/// Pixels in an ellipse around the middle: where the object is in a photo of one object.
Plane centred_mask(int width, int height);

/// Learns palette, views and classifier. Views without a picture are skipped; fails without any
/// class that has a view. More than `max_views` views of a class are thinned out evenly.
Expected<ObjectModels> train(const std::vector<TrainingClass>& classes,
                             const DescriptorOptions& options = {}, int max_views = 60);

/// Compares a descriptor with all classes, by the learned classifier or the nearest view.
Classification classify(const ObjectModels& models, const Eigen::VectorXf& descriptor,
                        bool learned = true);

/// Descriptor of a masked region of a quantised picture.
Eigen::VectorXf describe(const ObjectModels& models, const Plane& colours, const Plane& mask);

}  // namespace prehend::recognition
