#include "common/convert/detection.hpp"

#include "common/convert/convert.hpp"

namespace prehend::convert {

Expected<model::Detection> from_message(const v1::ObjectDetection& message) {
  const auto X_WO = from_message(message.X_WO());
  if (!X_WO) return fail("pose of a detection not usable");
  return model::Detection{message.track(),
                          message.name().to_string(),
                          {from_message(message.shape()), from_message(message.size())},
                          *X_WO,
                          message.probability(),
                          from_ns(message.stamp_ns()),
                          Eigen::Matrix4d::Map(message.covariance().data())};
}

}  // namespace prehend::convert
