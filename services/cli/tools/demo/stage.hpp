#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/service/lab.hpp"
#include "services/cli/tools/demo/onlooker.hpp"
#include "services/cli/tools/demo/options.hpp"
#include "services/cli/tools/demo/rows.hpp"

namespace prehend::cli {

/// The lab of a demonstration: its scene, devices that are not there, and the services, in a rig of
/// its own. All ends with it.
class Stage {
 public:
  /// Both must outlive it.
  Stage(const DemoOptions& options, Onlooker& onlooker);

  /// Starts everything, the glove last.
  Trouble put_up();

  /// The glove's frames come from a file, which ends.
  bool plays_recording() const { return glove_row_.line == "file"; }
  bool glove_has_ended();
  const std::string& glove() const { return glove_.kind; }
  const std::string& hand() const { return hand_; }

 private:
  /// KIND[:DETAIL]
  struct Source {
    std::string kind, detail;
  };
  static Source source_of(const std::string& text);

  /// Asks the services what the glove and the camera are that were named.
  Trouble look_up();
  Trouble look_up_camera();
  /// Services may run in other folders, where a hand of this one goes by its whole path.
  std::string hand_setting() const;
  std::string arm_setting() const;
  /// What every service of this lab is told.
  std::vector<std::string> settings() const;

  Trouble start_recorder(std::vector<std::string> sets, const std::string& truth);
  Trouble start_console(const std::string& truth);
  Trouble start_services(const std::vector<std::string>& sets, const std::string& truth);
  Trouble start_robot(const std::vector<std::string>& sets);
  Trouble start_glove(const std::filesystem::path& scene_file, const std::string& truth);
  /// Starts a device that is not there, and waits until it is plugged in.
  Trouble emulate(const GloveRow& row, const std::filesystem::path& scene_file,
                  const std::string& port, std::vector<std::string> sets);

  Trouble await_service(const std::string& name);
  Trouble wait_for_port(const std::string& port, const std::string& name);
  /// A robot says something of its joints only when it is homed and follows.
  bool is_ready(const std::string& name) const;
  std::string missing() const;

  const DemoOptions& options_;
  Onlooker& onlooker_;
  Source glove_, camera_;
  std::vector<GloveRow> gloves_;  // that there are
  GloveRow glove_row_;
  CameraRow camera_row_;
  std::string hand_;
  std::optional<service::TemporaryFolder> folder_;
  std::optional<service::Lab> lab_;  // after the folder: stopped before it is removed
  std::vector<std::string> awaited_;
};

}  // namespace prehend::cli
