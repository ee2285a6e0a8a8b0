#pragma once

#include <deque>
#include <map>
#include <tuple>
#include <vector>

#include "common/recording/layout/layout.hpp"

namespace prehend::recording {

/// What a late reader of a recording's transient local topics would be given at a moment: of every
/// living instance the last samples, as many as its writer keeps.
class LatchedSamples {
 public:
  /// A sample that is kept. Its bytes are its own, the stream is that of take().
  struct Sample {
    const Stream* stream = nullptr;
    recording::mcap::Message head;  // without data
    recording::mcap::Bytes data;
    /// Valid as long as this sample.
    recording::mcap::Message message() const;
  };

  /// All messages up to the moment, in order of log time; others than of transient local topics are
  /// passed by. The stream must outlive this.
  void take(const Stream& stream, const recording::mcap::Message& message);

  /// In order of log time.
  std::vector<Sample> samples() const;

 private:
  using Instance = std::tuple<std::string, dds::Guid, dds::Guid>;  // topic, writer, instance
  std::map<Instance, std::deque<Sample>> alive_;
};

}  // namespace prehend::recording
