#pragma once

#include <csignal>

#include "common/dds/raw.hpp"
#include "services/recorder/service/tape.hpp"
#include "tests/integration/rig.hpp"

namespace prehend::integration {

using recorder::Played;

/// A lab with recorders and players in it.
class RecorderRig : public Rig {
 protected:
  /// In the test's folder.
  std::string file(const std::string& name) { return (folder_ / name).string(); }

  /// Starts to record into a file and returns when the recorder is at work.
  stage::Process record(const std::string& name, Strings more = {});
  stage::Process replay(const std::string& name, Strings more = {});
  /// Until the service says that it is there.
  void wait_for(const std::string& service);
  /// Ends it as a service manager does and returns its exit code; -1: it did not end.
  static int end(stage::Process& process, int signal = SIGTERM);

  /// Sends an order and returns the reply.
  v1::OperatorReply order(const std::string& target, const std::string& argument);

  /// The samples in a recording: of a topic, or all but those of the lab's own operation.
  static std::vector<Played> content(const std::string& path, const std::string& topic = "");
  static v1::ObjectDetection detection(std::uint32_t track, std::uint64_t number);

  static inline std::vector<recorder::Tape> tapes_;  // owners of the streams of contents

 private:
  std::optional<dds::Reader<v1::ServiceStatus>> statuses_;
  std::optional<dds::Writer<v1::OperatorCommand>> orders_;
  std::optional<dds::Reader<v1::OperatorReply>> replies_;
  int order_count_ = 0;
};

}  // namespace prehend::integration
