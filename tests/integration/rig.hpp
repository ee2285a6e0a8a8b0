#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/dds/participant.hpp"
#include "common/stage/process.hpp"
#include "tests/support/domains/domain_lease.hpp"

namespace prehend::integration {

using Strings = std::vector<std::string>;

/// Polls until the condition holds; false when it does not within the limit.
bool eventually(double limit_s, const std::function<bool()>& condition);

/// What a program that was run to its end said and how it ended.
struct Answer {
  int exit_code = -1;  // -1: it did not end in time
  std::string output, log;
};

/// A lab of real processes, on a DDS domain and in a partition of its own, with a folder that is
/// removed at the end. The test takes part in it.
class Rig : public testing::Test {
 protected:
  explicit Rig(dds::Network network = {});
  ~Rig() override;

  /// A program of the build.
  static std::string program(const std::string& name);
  /// An address of this machine whose port is this lab's, for a server that must be told it.
  std::string address(int number = 0) const;
  /// --config and --set so that a service joins this lab.
  Strings lab_arguments(const Strings& sets = {}) const;
  /// The arguments, and those by which a program joins this lab.
  Strings with_lab(Strings arguments) const;
  /// Starts prehend-NAME in this lab; its words go into a log that the test prints when it fails.
  stage::Process start(const std::string& name, const Strings& sets = {});
  stage::Process start_program(const std::string& name, const Strings& arguments);
  /// Runs a program to its end.
  Answer run(const std::string& name, const Strings& arguments, double limit_s);
  /// Draws a scene and returns its file.
  std::string scene(int seed);

  template <class P>
  dds::Reader<typename P::type> reader(const dds::Topic<P>& topic) {
    auto made = participant_->reader(topic);
    if (!made) throw std::runtime_error(made.error().message());
    return std::move(*made);
  }
  template <class P>
  dds::Writer<typename P::type> writer(const dds::Topic<P>& topic) {
    auto made = participant_->writer(topic);
    if (!made) throw std::runtime_error(made.error().message());
    return std::move(*made);
  }
  /// Until the program on the other side has matched the writer.
  template <class T>
  static void meet(dds::Writer<T>& writer, int readers = 1) {
    ASSERT_TRUE(eventually(10, [&] {
      eprosima::fastdds::dds::PublicationMatchedStatus status;
      writer.raw().get_publication_matched_status(status);
      return status.current_count >= readers;
    }));
  }

  /// The test takes part anew, on network_ as it is then. role: empty: it may give orders.
  void join(const std::string& role = {});

  dds::Network network_;
  const test::DomainLease lease_;
  const int domain_ = lease_.domain();
  std::string name_;
  std::filesystem::path folder_;
  std::optional<dds::Participant> participant_;
};

/// Waits for a sample that satisfies the condition and returns it.
template <class T>
std::optional<T> hear(dds::Reader<T>& reader, double limit_s,
                      const std::function<bool(const T&)>& condition) {
  std::optional<T> found;
  eventually(limit_s, [&] {
    for (auto& sample : reader.take())
      if (!sample.info.gone && !found && condition(sample.data)) found = sample.data;
    return found.has_value();
  });
  return found;
}

/// Now, as messages tell it.
std::int64_t now_ns();

/// Processes whose command line contains the text.
std::vector<pid_t> processes_with(const std::string& text);

}  // namespace prehend::integration
