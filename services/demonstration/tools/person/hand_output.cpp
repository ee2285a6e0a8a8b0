#include <memory>

#include "common/convert/convert.hpp"
#include "common/dds/topics.hpp"
#include "services/demonstration/tools/person/outputs.hpp"

namespace prehend::demonstration {

namespace {

constexpr double position_noise = 0.0015;  // m, sigma a coordinate of each sensor
constexpr double angle_noise = 0.005;      // rad, sigma of each sensor's rotation

constexpr std::array<std::pair<v1::SensorSite, model::Finger>, 3> finger_sites{
    {{v1::SITE_THUMB, model::Finger::thumb},
     {v1::SITE_INDEX, model::Finger::index},
     {v1::SITE_LITTLE, model::Finger::little}}};

v1::SensorReading reading(v1::SensorSite site, const Pose& X_TS, Random& random) {
  Pose noisy = X_TS;
  noisy.pretranslate(random.normal3(position_noise));
  const Eigen::Vector3d turn = random.normal3(angle_noise);
  if (turn.norm() > 0) noisy.rotate(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
  v1::SensorReading made;
  made.site(site);
  made.valid(true);
  made.X_TS(convert::to_message(noisy));
  return made;
}

}  // namespace

Output hand_output(service::Shell& shell, const Person& person, std::uint64_t seed) {
  const auto& numbers = shell.config().numbers("tracker.X_WT");
  const Pose X_TW = make_pose(Eigen::Vector3d(numbers[0], numbers[1], numbers[2]),
                              Eigen::Quaterniond(numbers[3], numbers[4], numbers[5], numbers[6]))
                        .inverse();
  const std::string glove = shell.config().text("glove.name");
  const auto frames = shell.publish(dds::glove_frame);
  const auto random = std::make_shared<Random>(seed);
  const auto count = std::make_shared<std::uint64_t>(0);
  return [=, &person](double t, Time stamp) {
    const Person::HandThen hand = person.hand(t);
    const auto tips = person.model().fingertip_poses(model::HumanHand::posture(hand.closure));
    v1::GloveFrame frame;
    frame.glove(glove);
    frame.sequence_number((*count)++);
    frame.stamp_ns(to_ns(stamp));
    frame.device("person");
    frame.sensors().push_back(reading(v1::SITE_BACK_OF_HAND, X_TW * hand.X_WH, *random));
    for (const auto& [site, finger] : finger_sites)
      frame.sensors().push_back(
          reading(site, X_TW * hand.X_WH * tips[static_cast<std::size_t>(finger)], *random));
    frames.publish(frame);
  };
}

}  // namespace prehend::demonstration
