#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "common/recording/layout/layout.hpp"
#include "common/recording/mcap/reader.hpp"

namespace prehend::recorder {

/// A message of a recording. The stream is the tape's.
struct Played {
  const recording::Stream* stream = nullptr;
  dds::RawSample sample;
  Time log_time;
};

/// One or several recordings (the parts of a split one) as one sequence of samples in order of log
/// time. What cannot be read is counted and passed by. Messages whose type has got more fields
/// since are of the newest one (older_types.hpp).
class Tape {
 public:
  using Wanted = std::function<bool(const std::string& topic)>;

  /// Fails when a file is no recording or holds none of the wanted topics.
  static Expected<Tape> open(const std::vector<std::filesystem::path>& files, const Wanted& wanted);

  Time recording_start() const { return recording_start_; }  // of the first message of any topic
  Time start() const { return start_; }                      // of the first wanted message
  Time end() const { return end_; }                          // of the last
  std::vector<const recording::Stream*> streams() const;
  const recording::mcap::Reader& file(std::size_t index) const { return files_[index]->reader; }

  /// The next message is the first one at or behind this time.
  void seek(Time time);
  /// Nothing at the end.
  std::optional<Played> next();
  /// What a late reader would have been given at this time: the last samples of living instances
  /// of transient local topics.
  std::vector<Played> standing(Time time);

  /// What could not be read, first things first, a hundred at most.
  const std::vector<Error>& damage() const { return damage_; }
  /// What is odd, but lost nothing.
  const std::vector<Error>& remarks() const { return remarks_; }

 private:
  struct File {
    recording::mcap::Reader reader;
    std::map<std::uint16_t, recording::Stream> streams;  // wanted ones, by channel
    std::set<const recording::Stream*> older;            // whose messages are of an older type
    std::optional<recording::mcap::MessageCursor> cursor;
    std::optional<Played> waiting;
  };
  void note(const Error& error);
  void advance(File& file);

  std::vector<std::unique_ptr<File>> files_;
  Time recording_start_{}, start_{}, end_{};
  std::vector<Error> damage_, remarks_;
};

}  // namespace prehend::recorder
