#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "common/recording/layout/layout.hpp"
#include "common/recording/mcap/reader.hpp"
#include "services/console/core/playback.hpp"
#include "services/console/core/protocol.hpp"
#include "services/console/service/mailbox.hpp"

namespace prehend::console {

/// A recording that plays by itself, over and over, unless clients lead it.
class Film {
 public:
  static Expected<std::unique_ptr<Film>> open(const std::filesystem::path& file);

  /// What was said since the last call.
  std::vector<Letter> letters(Time now);
  /// The recording's own time.
  Time time() const { return time_; }
  Span span() const { return {to_ns(begin_), to_ns(end_)}; }

  void obey(const PlaybackRequest& request);
  /// How it plays, when that is other than expected from the last call, and once a second.
  std::optional<PlaybackState> news(Time now);

 private:
  struct Channel {
    std::size_t place = 0;  // of its topic, in the table
    recording::Stream stream;
    bool older = false;  // its type has got more fields since
  };
  explicit Film(recording::mcap::Reader reader);
  void rewind();
  bool advance();
  std::vector<Letter> jump(Time to);

  recording::mcap::Reader reader_;
  std::map<std::uint16_t, Channel> channels_;  // by id
  std::optional<recording::mcap::MessageCursor> cursor_;
  std::optional<Letter> next_;
  Time next_time_{}, time_{}, begin_{}, end_{};
  std::optional<Time> last_call_, ended_, seek_, told_;
  bool playing_ = true;
  double speed_ = 1;
  bool sought_ = false;  // since the last news
  std::string asked_;    // id of the request that was obeyed last
};

}  // namespace prehend::console
