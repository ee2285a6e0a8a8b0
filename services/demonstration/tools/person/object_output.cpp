#include <memory>

#include "common/convert/convert.hpp"
#include "common/dds/topics.hpp"
#include "services/demonstration/tools/person/outputs.hpp"

namespace prehend::demonstration {

namespace {

constexpr double place_noise = 0.002;  // m
constexpr double turn_noise = 0.01;    // rad, about the vertical

}  // namespace

Output object_output(service::Shell& shell, const Person& person, std::uint64_t seed) {
  const auto detections = shell.publish(dds::object_detection);
  const auto random = std::make_shared<Random>(seed);
  const auto count = std::make_shared<std::uint64_t>(0);
  return [=, &person](double t, Time stamp) {
    std::uint32_t track = 0;
    for (const Person::ObjectThen& object : person.objects(t)) {
      v1::ObjectDetection message;
      message.track(++track);
      if (object.hidden) {
        detections.dispose(message);
        continue;
      }
      Pose X_WO = object.X_WO;
      X_WO.pretranslate(random->normal3(place_noise));
      X_WO.linear() = Eigen::AngleAxisd(random->normal(turn_noise), Eigen::Vector3d::UnitZ()) *
                      object.X_WO.linear();
      message.sequence_number((*count)++);
      message.stamp_ns(to_ns(stamp));
      message.name(object.name);
      message.shape(convert::to_message(object.shape.kind));
      message.size(convert::to_message(object.shape.size));
      message.X_WO(convert::to_message(X_WO));
      for (std::size_t i = 0; i < 4; ++i)
        message.covariance()[5 * i] = i < 3 ? place_noise * place_noise : turn_noise * turn_noise;
      message.probability(0.95);
      detections.publish(message);
    }
  };
}

}  // namespace prehend::demonstration
