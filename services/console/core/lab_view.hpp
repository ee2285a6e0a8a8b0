#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/model/hand_model.hpp"
#include "services/console/core/documents.hpp"
#include "services/console/core/roster.hpp"
#include "services/console/core/view.hpp"

namespace prehend::console {

/// Something for a feed. Of each key the newest one says all.
struct Document {
  Feed feed{};
  std::string key;
  std::int64_t stamp_ns = 0;
  std::string text = {};  // of a feed with a list: some elements of it
  /// What it tells of is over: who joins later is not told.
  bool last = false;
};
using Documents = std::vector<Document>;

/// Turns what the topics say into what viewers draw. Pure: messages in, documents out.
class LabView {
 public:
  struct Options {
    std::vector<std::string> services;  // that a whole lab has
    std::string camera = "camera";      // key of the camera whose picture is drawn
    Pose X_WC = Pose::Identity();       // where that camera stands on the table
    /// The hand of a model's name; nullptr: not known. What it points to stays.
    std::function<const model::HandModel*(const std::string& model)> hand = [](const std::string&) {
      return nullptr;
    };
  };
  explicit LabView(Options options) : options_(std::move(options)), roster_(options_.services) {}

  /// What is there before anybody says something: the table, the camera, who is missing.
  Documents begin(std::int64_t now_ns);
  /// A message on a topic. What is damaged or cannot be drawn gives nothing.
  Documents hear(std::string_view topic, const Value& message, std::int64_t now_ns);
  /// The end of an instance, by the last message of it.
  Documents lose(std::string_view topic, const Value& last, std::int64_t now_ns);
  /// Time has passed: who was killed, or is behind a broken network, says no farewell. Now and
  /// then.
  Documents wait(std::int64_t now_ns);

 private:
  struct Detection {
    std::string name;
    double probability = 0, x = 0, y = 0, width = 0, height = 0;
  };

  Documents robot_state(View message);
  Documents robot_touch(View message);
  Documents robot_command(View message);
  Documents object_state(View message);
  Documents scene_state(View message);
  Documents glove_feedback(View message);
  Documents hand_posture(View message);
  Documents camera_image(View message);
  Documents object_detection(View message);
  Documents grasp_report(const Value& value);
  Documents operator_reply(const Value& value);
  Documents operator_command(View message);

  Documents links_of(const std::string& hand, const model::HandModel& model, std::int64_t ns);
  Document annotations(std::int64_t ns) const;
  /// What has happened, and how it is now. at_ns: of what tells it.
  Documents told(const Roster::News& news, std::int64_t at_ns);
  Document status(std::int64_t ns) const;
  Document latency(std::int64_t ns) const;
  Document log(std::int64_t ns, LogLevel level, std::string_view name, std::string_view text);
  /// Numbers to be plotted over time. What is not finite is left out of a plot.
  static Document signals(std::int64_t ns, std::string_view group, const std::string& source,
                          std::string_view unit, Json names, Json values);
  static Document scene(Json entity, const std::string& key, std::int64_t ns);

  Options options_;
  std::map<std::string, std::string> drawn_hands_;             // model by hand
  std::map<std::string, std::set<std::string>> drawn_bodies_;  // by scene
  Roster roster_;
  std::map<std::int64_t, Detection> detections_;  // by track
  std::uint64_t count_ = 0;                       // of queued documents
};

}  // namespace prehend::console
