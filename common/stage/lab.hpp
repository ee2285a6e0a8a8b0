#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/stage/process.hpp"

namespace prehend::stage {

/// The processes of a lab on this machine. All are stopped when it goes.
class Lab {
 public:
  /// config, sets: what every service is started with; logs: folder for what they say.
  Lab(std::string config, std::vector<std::string> sets, std::filesystem::path logs);
  Lab(Lab&&) = default;
  ~Lab();

  /// Starts prehend-NAME with the lab's configuration and further overrides.
  Expected<void> start_service(const std::string& name, const std::vector<std::string>& sets = {});
  /// Starts a program from the folder of this one.
  Expected<void> start(const std::string& name, const std::string& program,
                       const std::vector<std::string>& arguments);
  /// How a process ended, if it did.
  std::optional<Process::Exit> ended(std::string_view name);
  /// The first process found dead, with the last lines it said. `may_end` may end with success.
  std::optional<Error> casualty(std::string_view may_end = {});
  /// Asks all to stop and kills those that do not within three seconds. The one that was started
  /// first is asked when the others have ended.
  void stop();

 private:
  struct Member {
    std::string name;
    Process process;
  };
  std::string config_;
  std::vector<std::string> sets_;
  std::filesystem::path logs_;
  std::vector<Member> members_;
};

}  // namespace prehend::stage
