#pragma once

#include <map>
#include <string>

#include "common/recording/mcap/reader.hpp"
#include "common/recording/types/type.hpp"

namespace prehend::recording {

/// What a channel of a recording is about. Channels of our recorder say so in their metadata (see
/// common/recording/layout/layout.hpp), others by topic and schema.
struct RecordedTopic {
  std::string name;
  std::string type;  // of DDS, or the schema's name
  /// «disposed» or «unregistered» and the instance, for channels of ends; empty for data.
  std::string end;
};

RecordedTopic recorded_topic(const recording::mcap::Channel& channel,
                             const recording::mcap::Contents& contents);

/// The type trees of a recording's channels, made from what the recording itself says: the IDL that
/// was kept beside, else its schema.
class RecordedTypes {
 public:
  /// The reader must outlive it.
  explicit RecordedTypes(const recording::mcap::Reader& reader);

  /// Nothing for ends of instances, for messages that are not CDR and for what is not described in
  /// a way that we read. Lives as long as this.
  const recording::types::Structure* of(const recording::mcap::Channel& channel);
  /// The same of messages of ROS 1.
  const recording::types::Structure* of_ros1(const recording::mcap::Channel& channel);

 private:
  const recording::types::Structure* known(const recording::mcap::Channel& channel);
  const recording::types::Structure* find(const recording::mcap::Channel& channel);

  const recording::mcap::Reader& reader_;
  std::map<std::string, std::string> idl_;  // by type
  // Each type has a library of its own: what it needs may be there in several versions.
  std::map<std::string, recording::types::Library> libraries_;
  std::map<std::uint16_t, const recording::types::Structure*> known_;
};

}  // namespace prehend::recording
