#include <map>
#include <memory>

#include "common/convert/convert.hpp"
#include "common/dds/topics.hpp"
#include "services/demonstration/tools/person/outputs.hpp"

namespace prehend::demonstration {

namespace {

constexpr double place_noise = 0.002;  // m
constexpr double turn_noise = 0.01;    // rad, about the vertical
constexpr Duration marker_period = std::chrono::milliseconds(50);

/// What a camera says of objects that it sees, with its noise.
class Camera {
 public:
  Camera(service::Shell& shell, std::uint64_t seed)
      : detections_(shell.publish(dds::object_detection)), random_(seed) {}

  void see(std::uint32_t track, const std::string& name, const model::Shape& shape, Pose X_WO,
           Time stamp) {
    const Eigen::Matrix3d R_WO = X_WO.linear();
    X_WO.pretranslate(random_.normal3(place_noise));
    X_WO.linear() = Eigen::AngleAxisd(random_.normal(turn_noise), Eigen::Vector3d::UnitZ()) * R_WO;
    v1::ObjectDetection message;
    message.track(track);
    message.sequence_number(count_++);
    message.stamp_ns(to_ns(stamp));
    message.name(name);
    message.shape(convert::to_message(shape.kind));
    message.size(convert::to_message(shape.size));
    message.X_WO(convert::to_message(X_WO));
    for (std::size_t i = 0; i < 4; ++i)
      message.covariance()[5 * i] = i < 3 ? place_noise * place_noise : turn_noise * turn_noise;
    message.probability(0.95);
    detections_.publish(message);
  }
  void lose(std::uint32_t track) {
    v1::ObjectDetection message;
    message.track(track);
    detections_.dispose(message);
  }

 private:
  service::Shell::Output<v1::ObjectDetection> detections_;
  Random random_;
  std::uint64_t count_ = 0;
};

}  // namespace

Output object_output(service::Shell& shell, const Person& person, std::uint64_t seed) {
  return [camera = std::make_shared<Camera>(shell, seed), &person](double t, Time stamp) {
    std::uint32_t track = 0;
    for (const Person::ObjectThen& object : person.objects(t)) {
      if (object.hidden)
        camera->lose(++track);
      else
        camera->see(++track, object.name, object.shape, object.X_WO, stamp);
    }
  };
}

MarkerOutput marker_output(service::Shell& shell, const model::Catalogue& catalogue,
                           std::uint64_t seed) {
  struct Marked {
    std::uint32_t track;
    Time seen{};
  };
  return [camera = std::make_shared<Camera>(shell, seed),
          all = std::make_shared<std::map<std::string, Marked>>(),
          &catalogue](const v1::ObjectState& state) {
    const std::string name = state.body().to_string();
    const model::CatalogueObject* object = catalogue.find(name);
    const auto X_WO = convert::from_message(state.X_WO());
    if (!object || !X_WO) return;
    Marked& marked =
        all->try_emplace(name, Marked{static_cast<std::uint32_t>(all->size() + 1)}).first->second;
    const Time stamp = from_ns(state.stamp_ns());
    if (stamp - marked.seen < marker_period) return;
    marked.seen = stamp;
    camera->see(marked.track, name, object->shape, *X_WO, stamp);
  };
}

}  // namespace prehend::demonstration
