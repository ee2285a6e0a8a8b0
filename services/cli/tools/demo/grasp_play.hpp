#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/model/scene.hpp"
#include "common/stage/stage.hpp"
#include "services/cli/service/listener.hpp"
#include "services/cli/service/observer.hpp"
#include "services/cli/tools/demo/options.hpp"
#include "services/cli/tools/demo/rows.hpp"

namespace prehend::cli {

/// A person reaches for an object of a drawn scene, a robot hand closes on it, and the simulation
/// judges: the services of that, devices that are not there, and what is seen of them.
class GraspPlay {
 public:
  /// Both must outlive it.
  GraspPlay(const DemoOptions& options, stage::Stage& stage);

  /// Starts everything, the glove last.
  Expected<void> put_up();
  /// Starts nothing: looks at the lab that runs.
  Expected<void> attach();

  const Observer& seen() const { return observer_; }
  /// The glove's frames come from a file, which ends.
  bool plays_recording() const { return glove_row_.line == "file"; }
  const std::string& glove() const { return glove_.kind; }
  const std::string& hand() const { return hand_; }

 private:
  /// KIND[:DETAIL]
  struct Source {
    std::string kind, detail;
  };
  static Source source_of(const std::string& text);

  /// Asks the services what the glove and the camera are that were named.
  Expected<void> look_up();
  Expected<void> look_up_camera();
  std::string arm_setting() const;
  /// Tells every service of this lab what was chosen.
  void choose();

  /// Hears the lab from now on. truth: what stands on the table, where that is known.
  Expected<void> listen(const service::Config& config, const std::optional<model::Scene>& truth);

  Expected<void> start_recorder(const std::string& truth);
  Expected<void> start_console(const std::string& truth);
  Expected<void> start_services(const std::string& truth);
  Expected<void> start_robot();
  Expected<void> await_plans();
  Expected<void> start_glove(const std::filesystem::path& scene_file, const std::string& truth);
  Expected<void> await_service(const std::string& name);
  /// A robot says something of its joints only when it is homed and follows.
  bool is_ready(const std::string& name) const;
  std::string missing() const;

  const DemoOptions& options_;
  stage::Stage& stage_;
  Observer observer_;
  std::optional<Listener> listener_;
  Source glove_, camera_;
  std::vector<GloveRow> gloves_;  // that there are
  GloveRow glove_row_;
  CameraRow camera_row_;
  std::string hand_;
  std::vector<std::string> awaited_;
};

}  // namespace prehend::cli
