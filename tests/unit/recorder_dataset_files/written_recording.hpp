#pragma once

#include <gtest/gtest.h>

#include <map>
#include <optional>

#include "services/recorder/service/describe.hpp"
#include "services/recorder/service/recording_file.hpp"
#include "tests/unit/recording/scratch.hpp"

namespace prehend::recorder::dataset {

inline Time ms(int t) {
  return from_ns(1'700'000'000'000'000'000 + t * 1'000'000ll);
}

/// A recording that is written message by message, as the recorder does it; times in ms.
class WrittenRecording {
 public:
  explicit WrittenRecording(const std::filesystem::path& path)
      : heading_{{{"lab.rig", "lab"}}, "", describe_types("ros2msg").value()},
        file_(RecordingFile::create(path, heading_, recording::mcap::Compression::zstd).value()) {}

  template <class Topic, class Message>
  void write(const Topic& topic, int t, const Message& message) {
    write(topic, ms(t), message);
  }
  template <class Topic, class Message>
  void write(const Topic& topic, Time t, const Message& message) {
    dds::RawSample sample;
    sample.kind = dds::RawSample::Kind::data;
    sample.payload = dds::encode(topic, message);
    sample.instance[15] = 1;
    sample.writer[0] = 7;
    sample.sequence = ++sequence_;
    sample.sent = t;
    const dds::RawTopic raw = dds::raw_topic(topic);
    // A source's address stands for it.
    const Source& source = sources_.try_emplace(raw.name, Source{raw, "lab"}).first->second;
    ASSERT_TRUE(file_.write(source, sample, t));
  }

  void command(int t, const std::string& hand, std::vector<double> dof,
               const std::string& model = "barrett") {
    v2::HandCommand message;
    message.hand(hand);
    message.model(model);
    message.dof(std::move(dof));
    message.X_WB().orientation().w(1);
    message.object("Wood cube");
    write(dds::robot_command, t, message);
  }

  void close() { ASSERT_TRUE(file_.close()); }

 private:
  Heading heading_;
  std::map<std::string, Source> sources_;
  RecordingFile file_;
  std::uint64_t sequence_ = 0;
};

}  // namespace prehend::recorder::dataset
