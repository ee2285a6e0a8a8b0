#include "services/ros/service/teller.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "common/base/clock.hpp"
#include "common/base/file_text.hpp"
#include "common/base/log.hpp"
#include "common/base/log_format.hpp"
#include "common/convert/convert.hpp"
#include "common/dds/topics.hpp"
#include "common/model/shape.hpp"
#include "common/ros2/joints.hpp"
#include "common/ros2/nodes/nodes.hpp"
#include "common/service/membership.hpp"
#include "services/ros/core/diagnostics.hpp"
#include "services/ros/core/wrist_goal.hpp"

namespace prehend::ros {
namespace {

struct Told {
  const char *name, *type;
  bool kept;  // who comes late gets the last one
};
/// In the order of Teller::Voice.
constexpr Told told_topics[] = {{"joint_states", "sensor_msgs/JointState", false},
                                {"robot_description", "std_msgs/String", true},
                                {"tf", "tf2_msgs/TFMessage", false},
                                {"tf_static", "tf2_msgs/TFMessage", true},
                                {"detections", "vision_msgs/Detection3DArray", false},
                                {"diagnostics", "diagnostic_msgs/DiagnosticArray", false},
                                {"camera/image/compressed", "sensor_msgs/CompressedImage", false},
                                {"camera/camera_info", "sensor_msgs/CameraInfo", false}};

Expected<Pose> pose_of(const std::vector<double>& v) {
  const char* key = "camera.X_WC";
  if (v.size() != 7)
    return wrong_use("needs seven numbers: x y z in m, then the quaternion w x y z", key);
  auto X = checked_pose({v[0], v[1], v[2]}, {v[3], v[4], v[5], v[6]});
  if (!X) return wrong_use(X.error().what, key);
  return X;
}

ros2::Lens lens_of(const service::Config& config) {
  const auto focal = config.numbers("camera.focal"), centre = config.numbers("camera.centre");
  if (focal.size() != 2 || centre.size() != 2) return {};
  return {.width = static_cast<std::uint32_t>(config.integer("camera.width")),
          .height = static_cast<std::uint32_t>(config.integer("camera.height")),
          .fx = focal[0],
          .fy = focal[1],
          .cx = centre[0],
          .cy = centre[1],
          .distortion = config.numbers("camera.distortion")};
}

Detection detection_of(const v1::ObjectDetection& seen, const Pose& X_WO) {
  const model::Shape shape{convert::from_message(seen.shape()), convert::from_message(seen.size())};
  return {seen.stamp_ns(),    seen.track(), seen.name().to_string(),
          seen.probability(), X_WO,         2 * model::half_extents(shape),
          seen.covariance()};
}

}  // namespace

Expected<std::unique_ptr<Teller>> Teller::create(const service::Config& config,
                                                 const Options& options) {
  std::unique_ptr<Teller> made(new Teller(options));
  made->told_ = {config.text("mapping.hand"), config.text("simulation.hand")};
  if (auto joined = made->join_nodes(config); !joined) return tl::unexpected(joined.error());
  if (auto joined = made->join_lab(config); !joined) return tl::unexpected(joined.error());
  return made;
}

Teller::~Teller() {
  // What still receives writes into news_.
  for (Reader* reader : {&hands_, &objects_, &reports_, &detections_, &pictures_}) reader->reset();
}

Expected<void> Teller::join_nodes(const service::Config& config) {
  const auto X_WC = pose_of(config.numbers("camera.X_WC"));
  if (!X_WC) return tl::unexpected(X_WC.error());
  camera_ = config.text("camera.name");
  lens_ = lens_of(config);
  const auto network = ros2::network_of_nodes(options_.network);
  if (!network) return tl::unexpected(network.error());
  auto joined =
      ros2::join_nodes("prehend_ros", options_.domain, *network, ros2::hosts_of_nodes(*network));
  if (!joined) return tl::unexpected(joined.error());
  nodes_.emplace(std::move(*joined));
  for (const auto& [name, type, kept] : told_topics) {
    auto writer = dds::RawWriter::create(*nodes_, ros2::topic_of_nodes(name, type, kept));
    if (!writer) return tl::unexpected(writer.error());
    voices_.push_back(std::move(*writer));
  }
  write(Voice::tf_static, tf_message({{to_ns(process_now()), table_frame, camera_, *X_WC}}));
  return {};
}

template <class Topic, class Keep>
Expected<Teller::Reader> Teller::listen(const Topic& topic, Keep keep) {
  return dds::RawReader::create(*lab_, dds::raw_topic(topic),
                                [this, &topic, keep](dds::RawSample&& sample) {
                                  typename Topic::Type message;
                                  const bool data = sample.kind == dds::RawSample::Kind::data;
                                  if (data && !dds::decode(topic, sample, message)) return;
                                  const std::scoped_lock lock(mutex_);
                                  keep(sample.instance, data ? &message : nullptr);
                                  come_.notify_one();
                                });
}

Expected<void> Teller::join_lab(const service::Config& config) {
  auto joined = dds::Participant::create(service::membership(config, "ros", "viewer"));
  if (!joined) return tl::unexpected(joined.error());
  lab_.emplace(std::move(*joined));
  const auto keep = [this](Reader& reader, const auto& topic, auto with) -> Expected<void> {
    auto made = listen(topic, with);
    if (!made) return tl::unexpected(made.error());
    reader = std::move(*made);
    return {};
  };
  return keep(hands_, dds::robot_state,
              [this](const dds::Guid&, const v1::HandState* state) {
                if (state) news_.hands.insert_or_assign(state->hand().to_string(), *state);
              })
      .and_then([&] {
        return keep(objects_, dds::object_state,
                    [this](const dds::Guid&, const v1::ObjectState* state) {
                      if (state) news_.objects.insert_or_assign(state->body().to_string(), *state);
                    });
      })
      .and_then([&] {
        return keep(reports_, dds::grasp_report,
                    [this](const dds::Guid&, const v1::GraspReport* report) {
                      if (report)
                        news_.reports.insert_or_assign(report->hand().to_string(), *report);
                    });
      })
      .and_then([&] {
        return keep(detections_, dds::object_detection,
                    [this](const dds::Guid& instance, const v1::ObjectDetection* detection) {
                      see(instance, detection);
                    });
      });
}

void Teller::see(const dds::Guid& instance, const v1::ObjectDetection* detection) {
  const auto X_WO = detection ? convert::from_message(detection->X_WO())
                              : Expected<Pose>(tl::unexpected(Error{}));
  if (X_WO)
    seen_.insert_or_assign(instance, detection_of(*detection, *X_WO));
  else
    seen_.erase(instance);
  news_.seen.emplace();
  for (const auto& [key, one] : seen_) news_.seen->push_back(one);
}

void Teller::listen_to_pictures() {
  const bool wanted = voice(Voice::picture).readers() + voice(Voice::lens).readers() > 0;
  if (wanted == (pictures_ != nullptr)) return;
  if (!wanted) return pictures_.reset();
  auto reader = listen(dds::camera_image, [this](const dds::Guid&, const v1::CameraImage* picture) {
    if (picture && picture->camera().to_string() == camera_) news_.picture = *picture;
  });
  if (reader)
    pictures_ = std::move(*reader);
  else
    log::warning(reader.error());
}

void Teller::tell(Duration limit) {
  listen_to_pictures();
  News news;
  {
    std::unique_lock lock(mutex_);
    come_.wait_for(lock, limit, [this] { return !news_.empty(); });
    news = std::exchange(news_, {});
  }
  for (const auto& [name, state] : news.hands) {
    if (options_.hand.empty()) options_.hand = name;
    if (name == options_.hand) tell(state);
  }
  for (const auto& [name, state] : news.objects) tell(state);
  for (const auto& [name, report] : news.reports) tell(report);
  if (news.picture) tell(*news.picture);
  if (!news.seen) return;
  std::int64_t newest = 0;
  for (const Detection& one : *news.seen) newest = std::max(newest, one.stamp_ns);
  write(Voice::detections,
        detections_message(newest > 0 ? newest : to_ns(process_now()), table_frame, *news.seen));
}

const model::HandModel* Teller::introduce(const std::string& name) {
  if (name == shown_) return model_ ? &*model_ : nullptr;
  shown_ = name;
  model_.reset();
  const auto folder = model::named_hand(name, told_);
  auto model = folder.and_then(model::HandModel::load);
  auto urdf = folder.and_then([](const auto& found) { return read_file(found / "hand.urdf"); });
  if (!model || !urdf) {
    log::warning(model ? urdf.error() : model.error());
    return nullptr;
  }
  write(Voice::description, text_message(*urdf));
  model_.emplace(std::move(*model));
  return &*model_;
}

void Teller::tell(const v1::HandState& state) {
  const model::HandModel* model = introduce(state.model().to_string());
  const auto X_WB = convert::from_message(state.X_WB());
  if (!model || !X_WB || state.joint().size() != model->joints().size()) return;
  const Eigen::VectorXd positions = convert::from_message(state.joint());
  if (!positions.allFinite()) return;
  ros2::Joints joints{state.stamp_ns(), model->links()[0].name, {}, state.joint(), {}, {}};
  for (const model::HandJoint& joint : model->joints()) joints.names.push_back(joint.name);
  // As many as there are joints, or none: so ROS 2 wants them.
  if (state.velocity().size() == joints.names.size()) joints.velocities = state.velocity();
  if (state.torque().size() == joints.names.size()) joints.efforts = state.torque();
  write(Voice::joint_states, ros2::joint_state(joints));
  write(Voice::tf,
        tf_message(transforms_of(*model, *X_WB, positions, table_frame, state.stamp_ns())));
}

void Teller::tell(const v1::ObjectState& state) {
  const auto X_WO = convert::from_message(state.X_WO());
  if (!X_WO) return;
  write(Voice::tf,
        tf_message({{state.stamp_ns(), table_frame, "object/" + state.body().to_string(), *X_WO}}));
}

void Teller::tell(const v1::GraspReport& report) {
  const auto number = [](double value) { return fmt::format("{:.4g}", value); };
  const std::string hand = report.hand().to_string();
  write(Voice::diagnostics,
        diagnostics_message(report.stamp_ns(),
                            {.good = report.held(),
                             .name = "prehend: grasp of " + hand,
                             .message = report.held() ? "held" : report.reason().to_string(),
                             .hardware = hand,
                             .values = {{"grasp", std::to_string(report.sequence_number())},
                                        {"object", report.object().to_string()},
                                        {"believed object", report.believed_object().to_string()},
                                        {"contacts", std::to_string(report.contacts().size())},
                                        {"epsilon", number(report.epsilon())},
                                        {"volume", number(report.volume())},
                                        {"penetration, m", number(report.penetration())},
                                        {"slip, m", number(report.slip())},
                                        {"turn, rad", number(report.turn())}}}));
}

void Teller::tell(const v1::CameraImage& picture) {
  write(Voice::picture, ros2::compressed_image({.stamp_ns = picture.stamp_ns(),
                                                .frame = camera_,
                                                .format = picture.encoding().to_string(),
                                                .data = picture.data()}));
  write(Voice::lens, ros2::camera_info(picture.stamp_ns(), camera_, lens_));
}

void Teller::write(Voice what, Bytes bytes) {
  dds::RawSample sample;
  sample.payload = std::move(bytes);
  voice(what).write(sample, process_now());
}

}  // namespace prehend::ros
