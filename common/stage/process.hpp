#pragma once

#include <sys/types.h>

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/time.hpp"

namespace prehend::stage {

/// A child process in a process group of its own, so that Ctrl-C reaches only the parent, which
/// then stops its children. None is left behind: the destructor kills it, and so does the kernel
/// when the thread that started it ends. Not safe for use from several threads.
class Process {
 public:
  struct Options {
    std::vector<std::string> command;  // program (searched on PATH without a slash), arguments
    std::filesystem::path log;         // takes standard output and error; empty: inherited
    std::filesystem::path output;      // takes standard output alone; empty: as above
    std::map<std::string, std::string> environment;  // added to the parent's
  };
  /// How a process ended.
  struct Exit {
    int code = 0;    // of exit(); 128 + signal when it was killed
    int signal = 0;  // 0: it ended by itself
  };

  static Expected<Process> start(const Options& options);
  Process(Process&& other) noexcept;
  Process& operator=(Process&& other) noexcept;
  ~Process();

  pid_t pid() const { return pid_; }
  const std::filesystem::path& log() const { return log_; }
  /// Nothing while it runs.
  std::optional<Exit> exit();
  /// Waits for its end; nothing when it still runs after `limit`.
  std::optional<Exit> wait(Duration limit);
  /// Sends a signal to the whole group, if it still runs.
  void signal(int number);
  /// SIGTERM, and SIGKILL when that did not help within `grace`.
  Exit stop(Duration grace);

 private:
  Process(pid_t pid, std::filesystem::path log) : pid_(pid), log_(std::move(log)) {}
  void kill_now();

  pid_t pid_ = -1;
  std::filesystem::path log_;
  std::optional<Exit> exit_;
};

/// What a program from the folder of this one prints, which must end within `patience`, with
/// success.
Expected<std::string> printed_by(const std::string& program,
                                 const std::vector<std::string>& arguments, Duration patience);

/// The last lines of a text file, for saying why a process ended; empty when there is none.
std::string last_lines(const std::filesystem::path& file, int lines);

}  // namespace prehend::stage
