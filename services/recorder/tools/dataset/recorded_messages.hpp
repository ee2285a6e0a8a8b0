#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/recording/mcap/reader.hpp"
#include "common/recording/messages/message_decoder.hpp"

namespace prehend::recorder::dataset {

/// Reads the messages of some topics, one after the other, and remembers what could not be.
class RecordedMessages {
 public:
  explicit RecordedMessages(recording::mcap::Reader& reader) : reader_(reader), decoder_(reader) {}

  /// take: what is wrong with a message, or nothing.
  void read(const std::function<bool(const std::string& topic)>& wanted,
            const std::function<Expected<void>(const std::string& topic,
                                               const recording::types::Value&, Time)>& take);

  /// Of each topic the first reason.
  std::vector<Error> damage() const;

 private:
  struct Unused {
    std::uint64_t count = 0;
    std::string why;
  };

  recording::mcap::Reader& reader_;
  recording::MessageDecoder decoder_;
  std::vector<Error> damage_;
  std::map<std::string, Unused> unused_;
};

/// The exit code of the error says whether it is there.
Expected<recording::mcap::Reader> open_recording(const std::filesystem::path& file);

/// When its first message was recorded.
Time first_time(recording::mcap::Reader& reader);

}  // namespace prehend::recorder::dataset
