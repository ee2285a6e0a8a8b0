#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "common/audit/record.hpp"
#include "common/base/error.hpp"

namespace prehend::audit {

struct LogOptions {
  std::filesystem::path folder;                  // where the files lie; it is made
  std::string name;                              // of the file: NAME.jsonl
  std::uintmax_t max_bytes = 8 << 20;            // of a file, before the next one is begun
  int max_files = 16;                            // kept, the oldest go
  Duration refusals = std::chrono::seconds(10);  // between two lines of one reason and writer
};

/// The audit log of one gate: a line an event, appended with one write each, so that what was said
/// is there when the process is killed. NAME.jsonl is the newest file, NAME.1.jsonl the one before.
class Log {
 public:
  /// Begins or goes on; makes the folder.
  static Expected<Log> open(const LogOptions& options);
  Log(Log&& other) noexcept;
  Log& operator=(Log&&) = delete;
  ~Log();

  /// False: it could not be written.
  bool write(const Record& record);
  /// A refusal: the first of its kind at once, then how many there were, now and then.
  bool refuse(const Record& record);
  /// Lines of refusals that are due; all: whatever has been counted.
  bool flush(Time now, bool all = false);

  std::filesystem::path file() const;

 private:
  struct Counted {
    Record last;
    Time written{};
    std::uint64_t since = 0;
  };
  explicit Log(const LogOptions& options) : options_(options) {}
  std::filesystem::path file(int number) const;
  Expected<void> open_file();
  void rotate();

  LogOptions options_;
  int descriptor_ = -1;
  std::uintmax_t bytes_ = 0;
  bool torn_ = false;                        // the last line has no end
  std::map<std::string, Counted> refusals_;  // by reason and writer
};

}  // namespace prehend::audit
