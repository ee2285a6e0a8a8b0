#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "common/model/catalogue.hpp"
#include "services/recognition/core/learning/object_models.hpp"
#include "services/recognition/core/placing/localise.hpp"
#include "services/recognition/core/scan/scan.hpp"

namespace prehend::recognition {

/// A box in the picture, px.
struct Box {
  double x = 0, y = 0, width = 0, height = 0;
};

/// An object seen in one picture.
struct Sighting {
  int class_index = -1;  // in the models
  std::string name;
  double probability = 0;  // that the name is right
  double by_colours = 0;   // the same before the outline was looked at; 0: they name another class
  Box box;
  model::Shape shape;  // kind unknown for objects that are in no catalogue
  /// With a calibrated camera and a known shape: where it stands.
  std::optional<TablePose> at;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // of x, y (m), yaw (rad)
  double agreement = 0;                                  // of the outline with the picture, 0..1
  /// Width and height measured in the picture, as shares of the catalogue's.
  Eigen::Vector2d measured = {1, 1};
  double contrast = 0;  // share of the outline along which the picture's colours change
  double hidden = 0;    // share of it that something unknown stands before
  Silhouette region;    // pixels it covers there
  bool fresh = true;    // measured in this picture; false: nothing moved since it was
};

struct DetectorOptions {
  ScanOptions scan;      // how pictures are searched
  double accept = 0.5;   // least probability of what is taken for true, and reported
  double doubtful = 1;   // least probability of what is reported although it is not accepted
  int max_objects = 12;  // in a picture
  int hypotheses = 4;    // classes tried at each place
  int max_tries = 16;    // places in a pass that turn out to be nothing before it ends
  /// The table top where objects are looked for: low x, high x, low y, high y in W, m.
  std::array<double, 4> table = {-0.65, 0.65, -0.5, 0.65};
};

/// Finds the objects of trained models in single pictures. Pure: the same picture gives the same
/// answer. Not safe for use from several threads.
class Detector {
 public:
  Detector(ObjectModels models, const model::Catalogue& catalogue, DetectorOptions options = {});

  /// On the lab's table, in the picture of its calibrated camera: name, place and turn of every
  /// object. Fails when the picture has not the camera's size.
  Expected<std::vector<Sighting>> on_table(const Picture& picture, const CameraModel& camera) const;

  /// The parts of on_table, for whoever looks at picture after picture.
  FittingImage prepare(const Picture& picture) const {
    return recognition::prepare(picture, models_.palette);
  }
  /// Adds what stands where no object is known yet to `found`, whose places are taken out of the
  /// frame. Examined are the cells of the scan that are 1 in `open`; they become 0, or stay 1 when
  /// `most` places have been examined before their turn came. What is doubtful goes to `doubtful`
  /// when there is one. Returns how many places were examined.
  int search(FittingImage& frame, const CameraModel& camera, Plane& open, int most,
             std::vector<Sighting>& found, std::vector<Sighting>* doubtful = nullptr) const;
  /// What is to be said of an object of the class near (x, y), however doubtful; none when no
  /// outline fits.
  std::optional<Sighting> judge(const FittingImage& frame, const CameraModel& camera,
                                std::size_t class_index, double x, double y) const;
  /// The same object near where it was; none when it is not surely there.
  std::optional<Sighting> follow(const FittingImage& frame, const CameraModel& camera,
                                 const Sighting& before) const;

  /// In any picture, without knowledge of the camera: names and boxes. Objects that fill the
  /// picture are found, too.
  std::vector<Sighting> in_picture(const Picture& picture) const;

  const ObjectModels& models() const { return models_; }
  const DetectorOptions& options() const { return options_; }

 private:
  struct Hypothesis;
  struct Tried;
  Sighting sighting_of(const Hypothesis& hypothesis) const;
  std::optional<Hypothesis> measure(const FittingImage& frame, const CameraModel& camera,
                                    std::size_t class_index, double x, double y,
                                    double reach) const;
  std::optional<Hypothesis> weigh(const FittingImage& frame, std::size_t class_index,
                                  Fit fit) const;
  std::optional<Hypothesis> examine(const FittingImage& frame, const CameraModel& camera,
                                    const Votes& votes, const Region& region,
                                    std::vector<Tried>& tried) const;

  ObjectModels models_;
  std::vector<model::Shape> shapes_;  // of each class; kind unknown where the catalogue has none
  DetectorOptions options_;
};

}  // namespace prehend::recognition
