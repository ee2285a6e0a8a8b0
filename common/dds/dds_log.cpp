#include "common/dds/dds_log.hpp"

#include <atomic>
#include <chrono>
#include <fastdds/dds/log/Log.hpp>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include "common/base/log.hpp"
#include "common/dds/release/fastdds.hpp"

namespace prehend::dds {

using eprosima::fastdds::dds::Log;

namespace {

/// Shared by the consumer, which Fast DDS calls in a thread of its own, and those that hear it.
struct CaptureState {
  std::mutex mutex;
  std::optional<std::string> category;  // that somebody hears
  std::string heard;
};
CaptureState& capture() {
  static auto* instance = new CaptureState;  // outlives the thread that logs
  return *instance;
}

std::atomic<bool> no_room = false;  // for handshakes

class Consumer : public eprosima::fastdds::dds::LogConsumer {
 public:
  void Consume(const Log::Entry& entry) override {
    if (entry.kind == Log::Info) return;
    const std::string_view category = entry.context.category ? entry.context.category : "";
    no_room = no_room || (category == "SECURITY" &&
                          entry.message.starts_with("WriterHistory cannot add the CacheChange_t"));
    {
      const std::scoped_lock lock(capture().mutex);
      if (capture().category == category) {
        capture().heard += (capture().heard.empty() ? "" : "; ") + entry.message;
        return;
      }
    }
    const auto now = std::chrono::steady_clock::now();
    // The place in the source tells the kind of complaint.
    Said& said = said_[{entry.context.filename ? entry.context.filename : "", entry.context.line}];
    if (said.count++ > 0 && now - said.last < std::chrono::seconds(10)) return;
    said.last = now;
    log::warning("Fast DDS, {}: {}{}", category, entry.message,
                 said.count > 1 ? fmt::format(" ({} such)", said.count) : "");
  }

 private:
  struct Said {
    std::chrono::steady_clock::time_point last{};
    std::uint64_t count = 0;
  };
  std::map<std::pair<std::string, int>, Said> said_;
};

}  // namespace

bool handshakes_are_used_up() {
  // Fast DDS 2.9 forgets such peers when their lease ends.
  return PREHEND_FAST_DDS > 2 && no_room;
}

void DdsLog::install() {
  Log::ClearConsumers();
  Log::RegisterConsumer(std::make_unique<Consumer>());
}

DdsLog::Capture::Capture(std::string category) {
  Log::Flush();
  Log::SetVerbosity(Log::Warning);
  const std::scoped_lock lock(capture().mutex);
  capture().category = std::move(category);
  capture().heard.clear();
}

DdsLog::Capture::~Capture() {
  Log::Flush();
  Log::SetVerbosity(Log::Error);
  const std::scoped_lock lock(capture().mutex);
  capture().category.reset();
}

std::string DdsLog::Capture::text() const {
  Log::Flush();
  const std::scoped_lock lock(capture().mutex);
  return capture().heard;
}

}  // namespace prehend::dds
