#include "services/ros/service/teller.hpp"

#include <utility>

#include "common/base/clock.hpp"
#include "common/base/file_text.hpp"
#include "common/base/log.hpp"
#include "common/base/log_format.hpp"
#include "common/convert/convert.hpp"
#include "common/dds/topics.hpp"
#include "common/ros2/joints.hpp"
#include "common/ros2/nodes/nodes.hpp"
#include "common/service/membership.hpp"

namespace prehend::ros {
namespace {

constexpr const char* table = "table";

Expected<Pose> pose_of(const std::vector<double>& v) {
  if (v.size() != 7) return wrong_use("is no pose", "camera.X_WC", "seven numbers");
  return checked_pose({v[0], v[1], v[2]}, {v[3], v[4], v[5], v[6]});
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
  hands_.reset();
  objects_.reset();
}

Expected<void> Teller::join_nodes(const service::Config& config) {
  const auto X_WC = pose_of(config.numbers("camera.X_WC"));
  if (!X_WC) return tl::unexpected(X_WC.error());
  auto joined = ros2::join_nodes("prehend_ros", options_.domain, options_.network);
  if (!joined) return tl::unexpected(joined.error());
  nodes_.emplace(std::move(*joined));
  auto made = voices();
  if (!made) return tl::unexpected(made.error());
  voices_.emplace(std::move(*made));
  write(voices_->tf_static,
        tf_message({{to_ns(process_now()), table, config.text("camera.name"), *X_WC}}));
  return {};
}

Expected<Teller::Voices> Teller::voices() {
  const auto writer = [this](const char* name, const char* type, bool kept) {
    return dds::RawWriter::create(*nodes_, ros2::topic_of_nodes(name, type, kept));
  };
  auto joints = writer("joint_states", "sensor_msgs/JointState", false);
  if (!joints) return tl::unexpected(joints.error());
  auto text = writer("robot_description", "std_msgs/String", true);
  if (!text) return tl::unexpected(text.error());
  auto moving = writer("tf", "tf2_msgs/TFMessage", false);
  if (!moving) return tl::unexpected(moving.error());
  auto fixed = writer("tf_static", "tf2_msgs/TFMessage", true);
  if (!fixed) return tl::unexpected(fixed.error());
  return Voices{std::move(*joints), std::move(*text), std::move(*moving), std::move(*fixed)};
}

Expected<void> Teller::join_lab(const service::Config& config) {
  auto joined = dds::Participant::create(service::membership(config, "ros", "viewer"));
  if (!joined) return tl::unexpected(joined.error());
  lab_.emplace(std::move(*joined));
  const auto read = [this](const auto& topic, auto keep) {
    return dds::RawReader::create(
        *lab_, dds::raw_topic(topic), [this, &topic, keep](dds::RawSample&& sample) {
          typename std::decay_t<decltype(topic)>::Type message;
          if (sample.kind != dds::RawSample::Kind::data || !dds::decode(topic, sample, message))
            return;
          const std::scoped_lock lock(mutex_);
          keep(message);
          come_.notify_one();
        });
  };
  auto hands = read(dds::robot_state, [this](const v1::HandState& state) {
    news_.hands.insert_or_assign(state.hand().to_string(), state);
  });
  if (!hands) return tl::unexpected(hands.error());
  hands_ = std::move(*hands);
  auto objects = read(dds::object_state, [this](const v1::ObjectState& state) {
    news_.objects.insert_or_assign(state.body().to_string(), state);
  });
  if (!objects) return tl::unexpected(objects.error());
  objects_ = std::move(*objects);
  return {};
}

void Teller::tell(Duration limit) {
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
  write(voices_->description, text_message(*urdf));
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
  write(voices_->joint_states, ros2::joint_state(joints));
  write(voices_->tf, tf_message(transforms_of(*model, *X_WB, positions, table, state.stamp_ns())));
}

void Teller::tell(const v1::ObjectState& state) {
  const auto X_WO = convert::from_message(state.X_WO());
  if (!X_WO) return;
  write(voices_->tf,
        tf_message({{state.stamp_ns(), table, "object/" + state.body().to_string(), *X_WO}}));
}

void Teller::write(dds::RawWriter& writer, Bytes bytes) {
  dds::RawSample sample;
  sample.payload = std::move(bytes);
  writer.write(sample, process_now());
}

}  // namespace prehend::ros
