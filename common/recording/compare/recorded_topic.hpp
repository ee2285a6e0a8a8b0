#pragma once

#include <map>
#include <prehend/mcap/reader.hpp>
#include <prehend/types/type.hpp>
#include <string>

namespace prehend::recording {

/// What a channel of a recording is about. Channels of our recorder say so in their metadata (see
/// prehend/recording_layout/layout.hpp), others by topic and schema.
struct RecordedTopic {
  std::string name;
  std::string type;  // of DDS, or the schema's name
  /// «disposed» or «unregistered» and the instance, for channels of ends; empty for data.
  std::string end;
};

RecordedTopic recorded_topic(const mcap::Channel& channel, const mcap::Contents& contents);

/// The type trees of a recording's channels, made from what the recording itself says: the IDL that
/// was kept beside, else a ros2msg or omgidl schema.
class RecordedTypes {
 public:
  /// The reader must outlive it.
  explicit RecordedTypes(const mcap::Reader& reader);

  /// Nothing for ends of instances, for messages that are not CDR and for what is not described in
  /// a way that we read. Lives as long as this.
  const types::Structure* of(const mcap::Channel& channel);

 private:
  const types::Structure* find(const mcap::Channel& channel);

  const mcap::Reader& reader_;
  std::map<std::string, std::string> idl_;  // by type
  // Each type has a library of its own: what it needs may be there in several versions.
  std::map<std::string, types::Library> libraries_;
  std::map<std::uint16_t, const types::Structure*> known_;
};

}  // namespace prehend::recording
