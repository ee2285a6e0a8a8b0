#include "services/recognition/files/model_file.hpp"

#include "common/proto/object_model.pb.h"
#include "common/proto/sealed_file.hpp"

namespace prehend::recognition {
namespace {

constexpr const char* kind = "object-models";

void put(const Eigen::MatrixXf& matrix, messages::Matrix& message) {
  message.set_rows(static_cast<std::uint32_t>(matrix.rows()));
  message.set_columns(static_cast<std::uint32_t>(matrix.cols()));
  message.mutable_values()->Add(matrix.data(), matrix.data() + matrix.size());
}

/// Empty where the sizes do not fit the values; the check of the models then refuses it.
Eigen::MatrixXf take(const messages::Matrix& message) {
  const std::uint64_t size = std::uint64_t{message.rows()} * message.columns();
  if (size != static_cast<std::uint64_t>(message.values_size())) return {};
  return Eigen::Map<const Eigen::MatrixXf>(message.values().data(), message.rows(),
                                           message.columns());
}

template <class Repeated>
Eigen::VectorXf take_vector(const Repeated& values) {
  return Eigen::Map<const Eigen::VectorXf>(values.data(), values.size());
}

}  // namespace

std::string to_bytes(const ObjectModels& models) {
  messages::ObjectModelSet set;
  set.set_brightness_weight(models.palette.space().brightness_weight);
  set.set_dark(models.palette.space().dark);
  set.set_constancy(static_cast<std::uint32_t>(models.palette.space().constancy));
  set.set_colours(static_cast<std::uint32_t>(models.palette.space().colours));
  set.set_weighting(static_cast<std::uint32_t>(models.weighting));
  set.set_same_pairs(models.same_pairs);
  Eigen::MatrixXf palette(3, models.palette.size());
  for (int k = 0; k < models.palette.size(); ++k)
    palette.col(k) = models.palette.centres()[static_cast<std::size_t>(k)];
  put(palette, *set.mutable_palette());
  for (const int c : models.coarse) set.add_coarse(static_cast<std::uint32_t>(c));
  set.set_coarse_colours(static_cast<std::uint32_t>(models.coarse_colours));
  for (const int d : models.distances) set.add_distances(static_cast<std::uint32_t>(d));
  set.mutable_idf()->Add(models.idf.data(), models.idf.data() + models.idf.size());
  for (const ObjectClass& c : models.classes) {
    messages::ObjectClassModel& entry = *set.add_classes();
    entry.set_name(c.name);
    entry.mutable_colours()->Add(c.colours.data(), c.colours.data() + c.colours.size());
    put(c.prototypes, *entry.mutable_prototypes());
  }
  put(models.views, *set.mutable_views());
  for (const int c : models.view_class) set.add_view_class(c);
  for (const int f : models.view_fold) set.add_view_fold(static_cast<std::uint32_t>(f));
  put(models.dual, *set.mutable_dual());
  set.set_kernel_sharpness(models.kernel_sharpness);
  for (int i = 0; i < 4; ++i) set.add_calibration(models.calibration.w[i]);
  return set.SerializeAsString();
}

Expected<ObjectModels> from_bytes(const std::string& bytes) {
  messages::ObjectModelSet set;
  if (!set.ParseFromString(bytes)) return fail("is no set of object models", "object models");
  const Eigen::MatrixXf colours = take(set.palette());
  if (colours.rows() != 3 || colours.cols() < 1 || colours.cols() > Palette::max_colours ||
      !colours.allFinite() || !(set.dark() >= 0 && set.dark() < 1000) ||
      !(set.brightness_weight() >= 0 && set.brightness_weight() < 1000) || set.constancy() > 2 ||
      set.colours() > 1 || set.weighting() > 2)
    return fail("descriptor is wrong", "object models", "train again: prehend objects train");
  std::vector<Eigen::Vector3f> centres;
  for (Eigen::Index k = 0; k < colours.cols(); ++k) centres.emplace_back(colours.col(k));
  const ColourSpace space{set.brightness_weight(), set.dark(),
                          static_cast<Constancy>(set.constancy()),
                          static_cast<Colours>(set.colours())};
  ObjectModels models{.palette = Palette(space, std::move(centres))};
  models.kernel_sharpness = set.kernel_sharpness();
  models.weighting = static_cast<Weighting>(set.weighting());
  models.same_pairs = set.same_pairs();
  for (const std::uint32_t c : set.coarse()) models.coarse.push_back(static_cast<int>(c));
  models.coarse_colours = static_cast<int>(set.coarse_colours());
  for (const std::uint32_t d : set.distances()) models.distances.push_back(static_cast<int>(d));
  models.idf = take_vector(set.idf());
  for (const messages::ObjectClassModel& c : set.classes())
    models.classes.push_back({c.name(), take_vector(c.colours()), take(c.prototypes())});
  models.views = take(set.views());
  models.view_class.assign(set.view_class().begin(), set.view_class().end());
  for (const std::uint32_t f : set.view_fold()) models.view_fold.push_back(static_cast<int>(f));
  models.dual = take(set.dual());
  if (set.calibration_size() != 4)
    return fail("calibration is wrong", "object models", "train again: prehend objects train");
  for (int i = 0; i < 4; ++i) models.calibration.w[i] = set.calibration(i);
  if (auto good = models.check(); !good) return tl::unexpected(good.error());
  return models;
}

Expected<void> save_models(const std::filesystem::path& file, const ObjectModels& models) {
  return proto::write_sealed(file, kind, to_bytes(models));
}

Expected<ObjectModels> load_models(const std::filesystem::path& file) {
  const auto bytes = proto::read_sealed(file, kind);
  if (!bytes) return tl::unexpected(bytes.error());
  auto models = from_bytes(*bytes);
  if (!models) return fail(models.error().what, file.string(), models.error().hint);
  return models;
}

}  // namespace prehend::recognition
