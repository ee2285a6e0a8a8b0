#pragma once

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "services/recorder/service/describe.hpp"
#include "services/recorder/service/recording_file.hpp"
#include "services/recorder/service/tape.hpp"
#include "tests/support/command_test.hpp"
#include "tests/support/paths/paths.hpp"
#include "tests/unit/recording/scratch.hpp"

namespace prehend::recorder {
using Json = nlohmann::json;
using dds::RawSample;
using test::Answer;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

inline constexpr std::int64_t begin_ns = 1'700'000'000'000'000'000;

struct Changes {
  double weight = 0;             // added to the seventh command
  bool without_seventh = false;  // it is missing
  std::int64_t later_ns = 0;     // everything was received and sent later
};

/// `prehend recording` in a folder of its own.
///
/// The recordings: detections of two objects (transient local, the last one of each stands),
/// commands for a hand (volatile), ten of each, every 100 ms; the second object is gone at 0.55 s.
class RecordingCommand : public ::testing::Test {
 protected:
  /// Runs shell text in the test's folder, with the programs of this build.
  Answer run(const std::string& text) {
    return test::answer_to("cd " + (scratch_ / "").string() + " && PATH=" + test::in_programs("") +
                               ":$PATH && (" + text + "\n)",
                           scratch_ / "");
  }

  void make(const std::string& name, const Changes& changes = {}) {
    const Heading heading{{{"lab.rig", "lab"}}, "a = 1\n", describe_types("ros2msg").value()};
    auto file =
        RecordingFile::create(scratch_ / name, heading, recording::mcap::Compression::zstd).value();
    const Source detections{dds::raw_topic(dds::object_detection), "lab"};
    const Source commands{dds::raw_topic(dds::robot_command), "lab"};
    const auto write = [&](const Source& source, RawSample::Kind kind, std::uint8_t instance,
                           std::uint64_t number, int ms, std::vector<std::uint8_t> payload) {
      RawSample sample;
      sample.kind = kind;
      sample.payload = std::move(payload);
      sample.instance[15] = instance;
      sample.writer[0] = 7;
      sample.sequence = number;
      sample.sent = from_ns(begin_ns + ms * 1'000'000ll + changes.later_ns);
      ASSERT_TRUE(file.write(source, sample, sample.sent));
    };
    for (int i = 0; i < 10; ++i) {
      const std::uint64_t number = static_cast<std::uint64_t>(i) + 1;
      const std::uint8_t track = static_cast<std::uint8_t>(1 + i % 2);
      v1::ObjectDetection detection;
      detection.track(track);
      detection.name("Cup, \"large\"");
      detection.stamp_ns(begin_ns + i * 100'000'000ll);
      detection.sequence_number(number);
      if (i < 6 || track == 1)
        write(detections, RawSample::Kind::data, track, number, 100 * i,
              dds::encode(dds::object_detection, detection));
      if (i == 5) write(detections, RawSample::Kind::disposed, 2, number + 1, 550, {});
      v2::HandCommand command;
      command.hand("hand");
      command.origin_ns(begin_ns + i * 100'000'000ll);
      command.dof({0.1 * i, -1});
      command.weight(0.5);
      if (i == 6) command.weight(0.5 + changes.weight);
      if (i == 6 && changes.without_seventh) continue;
      write(commands, RawSample::Kind::data, 1, number, 100 * i + 20,
            dds::encode(dds::robot_command, command));
    }
    ASSERT_TRUE(file.write_losses({{"robot/command", 3}}));
    ASSERT_TRUE(file.close());
  }
  /// Cut off, as of a recorder that was killed.
  void make_killed(const std::string& name) {
    make(name);
    auto bytes = testing::file_bytes(scratch_ / name);
    bytes.resize(bytes.size() * 2 / 3);
    testing::write_bytes(scratch_ / name, bytes);
  }
  /// Without summary and end, all its messages there, as when a recorder is killed while it waits.
  void make_unfinished(const std::string& name) {
    make(name);
    auto bytes = testing::file_bytes(scratch_ / name);
    const auto reader = recording::mcap::Reader::open(scratch_ / name).value();
    const auto& last = reader.contents().chunks.back();
    bytes.resize(last.chunk_start_offset + last.chunk_length + last.message_index_length);
    testing::write_bytes(scratch_ / name, bytes);
  }
  std::vector<Played> content(const std::string& name) {
    tapes_.push_back(
        Tape::open({scratch_ / name}, [](const std::string&) { return true; }).value());
    std::vector<Played> all;
    while (auto one = tapes_.back().next()) all.push_back(std::move(*one));
    return all;
  }

  const testing::Scratch scratch_;
  std::vector<Tape> tapes_;
};

}  // namespace prehend::recorder
