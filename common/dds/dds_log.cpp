#include "dds_log.hpp"

#include <chrono>
#include <fastdds/dds/log/Log.hpp>
#include <map>
#include <mutex>
#include <optional>
#include <prehend/base/log.hpp>
#include <utility>

namespace prehend::dds {

using eprosima::fastdds::dds::Log;

namespace {

/// Shared by the consumer, which Fast DDS calls in a thread of its own, and those that hear it.
struct Ear {
  std::mutex mutex;
  std::optional<std::string> category;  // that somebody hears
  std::string heard;
};
Ear& ear() {
  static auto* instance = new Ear;  // outlives the thread that logs
  return *instance;
}

class Consumer : public eprosima::fastdds::dds::LogConsumer {
 public:
  void Consume(const Log::Entry& entry) override {
    if (entry.kind == Log::Info) return;
    const std::string_view category = entry.context.category ? entry.context.category : "";
    {
      const std::scoped_lock lock(ear().mutex);
      if (ear().category == category) {
        ear().heard += (ear().heard.empty() ? "" : "; ") + entry.message;
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

void DdsLog::install() {
  Log::ClearConsumers();
  Log::RegisterConsumer(std::make_unique<Consumer>());
}

DdsLog::Hearing::Hearing(std::string category) {
  Log::Flush();
  Log::SetVerbosity(Log::Warning);
  const std::scoped_lock lock(ear().mutex);
  ear().category = std::move(category);
  ear().heard.clear();
}

DdsLog::Hearing::~Hearing() {
  Log::Flush();
  Log::SetVerbosity(Log::Error);
  const std::scoped_lock lock(ear().mutex);
  ear().category.reset();
}

std::string DdsLog::Hearing::text() const {
  Log::Flush();
  const std::scoped_lock lock(ear().mutex);
  return ear().heard;
}

}  // namespace prehend::dds
