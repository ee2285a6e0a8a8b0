#pragma once

#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/dds/participant.hpp"
#include "common/dds/raw.hpp"
#include "common/model/hand_model.hpp"
#include "common/ros2/pictures.hpp"
#include "common/service/config.hpp"
#include "services/ros/core/detections.hpp"
#include "services/ros/core/messages.hpp"

namespace prehend::ros {

/// Reads the hand, the objects, what the camera sees and how grasps were judged in a lab, and tells
/// nodes of ROS 2 in their own words. It is two participants: a viewer of the lab, and one without
/// partition where nodes look for topics.
class Teller {
 public:
  struct Options {
    int domain = 0;       // ROS_DOMAIN_ID
    std::string network;  // how nodes are reached; empty: as their environment says
    std::string hand;     // the robot hand that is told; empty: the first that is heard
  };
  static Expected<std::unique_ptr<Teller>> create(const service::Config& config,
                                                  const Options& options);
  ~Teller();
  Teller(const Teller&) = delete;
  Teller& operator=(const Teller&) = delete;

  /// Tells what has come since, or waits for it as long as `limit`.
  void tell(Duration limit);

 private:
  /// The newest of each, until it is told. Written by the threads that receive.
  struct News {
    std::map<std::string, v1::HandState> hands;
    std::map<std::string, v1::ObjectState> objects;
    std::map<std::string, v1::GraspReport> reports;  // by hand
    std::optional<std::vector<Detection>> seen;      // if that has changed
    std::optional<v1::CameraImage> picture;
    bool empty() const {
      return hands.empty() && objects.empty() && reports.empty() && !seen && !picture;
    }
  };
  /// What is told; each has a row in the table of topics.
  enum class Voice {
    joint_states,
    description,
    tf,
    tf_static,
    detections,
    diagnostics,
    picture,
    lens
  };
  using Reader = std::unique_ptr<dds::RawReader>;

  explicit Teller(Options options) : options_(std::move(options)) {}
  Expected<void> join_lab(const service::Config& config);
  Expected<void> join_nodes(const service::Config& config);
  /// keep: gets each message, or nothing when its instance has ended; called with mutex_ held.
  template <class Topic, class Keep>
  Expected<Reader> listen(const Topic& topic, Keep keep);
  /// Pictures are large: they are read in the lab while a node reads them here.
  void listen_to_pictures();
  void see(const dds::Guid& instance, const v1::ObjectDetection* detection);
  void tell(const v1::HandState& state);
  void tell(const v1::ObjectState& state);
  void tell(const v1::GraspReport& report);
  void tell(const v1::CameraImage& picture);
  /// Nothing: it is not known.
  const model::HandModel* introduce(const std::string& model);
  dds::RawWriter& voice(Voice what) { return voices_[static_cast<std::size_t>(what)]; }
  void write(Voice what, Bytes bytes);

  Options options_;
  std::vector<std::string> told_;  // hands that lab.toml names
  std::string shown_;              // the model that nodes know
  std::optional<model::HandModel> model_;
  std::string camera_;  // its name, and that of its frame
  ros2::Lens lens_;
  std::mutex mutex_;  // guards news_ and seen_
  std::condition_variable come_;
  News news_;
  std::map<dds::Guid, Detection> seen_;
  std::optional<dds::Participant> nodes_, lab_;
  std::vector<dds::RawWriter> voices_;  // by Voice
  Reader hands_, objects_, reports_, detections_, pictures_;
};

}  // namespace prehend::ros
