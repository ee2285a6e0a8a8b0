#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/service/arguments.hpp"
#include "common/stage/lab.hpp"
#include "common/stage/temporary_folder.hpp"

namespace prehend::stage {

/// Says how it goes: a few words, several times a second.
using Progress = std::function<void(const std::string&)>;

struct StageOptions {
  service::LabArguments lab;  // its configuration; the rig is one of its own
  double timeout = 45;        // s from now, or from begin_anew(), for all that is awaited
  bool keep = false;          // the folder with scenes and logs stays
  Progress progress = [](const std::string&) {};
};

/// Where a play is given: a lab of processes on this machine, in a rig of its own, so that neither
/// other plays nor a real lab are disturbed. All that is awaited ends at one deadline, when a
/// process has died, or when somebody presses Ctrl-C; all processes end with the stage, and none is
/// left behind. From one thread.
class Stage {
 public:
  /// Makes the folder. From now on Ctrl-C is noted.
  static Expected<Stage> create(const StageOptions& options);

  /// Told to every process that is started from now on: table.key=value.
  void set(std::string setting) { sets_.push_back(std::move(setting)); }
  const std::vector<std::string>& sets() const { return sets_; }
  std::string file() const { return options_.lab.file(); }
  /// As the processes read it. Fails with exit_wrong_use.
  Expected<service::Config> config() const;
  const std::filesystem::path& folder() const { return folder_.path(); }

  /// Starts prehend-NAME in this lab.
  Expected<void> start_service(const std::string& name, const std::vector<std::string>& sets = {});
  /// Starts a program from the folder of this one, in this lab: it takes --config and --set.
  Expected<void> start(const std::string& name, const std::string& program,
                       std::vector<std::string> arguments,
                       const std::vector<std::string>& sets = {});
  /// Runs one to its end. what: said meanwhile. output: takes its standard output; what it says
  /// besides is in PROGRAM.log.
  Expected<Process::Exit> run(const std::string& what, const std::string& program,
                              std::vector<std::string> arguments,
                              const std::vector<std::string>& sets,
                              const std::filesystem::path& output = {});
  /// The last line of what NAME said.
  std::string last_words(const std::string& name) const;
  /// Has this process ended?
  bool has_ended(std::string_view name);
  /// This one may end, with success, before the play does.
  void may_end(std::string name) { may_end_ = std::move(name); }

  /// Called whenever something is awaited, to hear the lab; returns what goes on, in a few words.
  void on_look(std::function<std::string()> look) { look_ = std::move(look); }
  /// Looks once, after a moment. Fails when a process has died, or with exit_no on Ctrl-C.
  Expected<void> look(const std::string& what);
  /// Looks until it holds. late: what is wrong when it never does.
  Expected<void> until(const std::string& what, const std::function<bool()>& holds,
                       const std::function<Error()>& late);
  /// Until the file is there.
  Expected<void> until_there(const std::string& what, const std::filesystem::path& file,
                             const std::function<Error()>& late);
  /// What is awaited from now on has the whole time again.
  void begin_anew();
  bool is_late() const { return std::chrono::steady_clock::now() >= end_; }

 private:
  std::filesystem::path log_of(const std::string& name) const;
  Stage(const StageOptions& options, TemporaryFolder folder);
  std::vector<std::string> with_lab(std::vector<std::string> arguments,
                                    const std::vector<std::string>& sets) const;

  StageOptions options_;
  std::chrono::steady_clock::time_point end_;
  std::vector<std::string> sets_;
  TemporaryFolder folder_;
  Lab lab_;  // after the folder: stopped before it is removed
  std::string may_end_;
  std::function<std::string()> look_ = [] { return std::string(); };
};

}  // namespace prehend::stage
