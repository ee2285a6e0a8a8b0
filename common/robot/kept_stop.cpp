#include "common/robot/kept_stop.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "common/audit/record.hpp"
#include "common/base/clock.hpp"
#include "common/base/file_text.hpp"
#include "common/base/paths.hpp"

namespace prehend::robot {
namespace {

/// Different names stay different, and no name leads to another folder.
std::string spelt(const std::string& name) {
  std::string text;
  for (const char c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_')
      text += c;
    else
      text += fmt::format("%{:02x}", static_cast<unsigned char>(c));
  return text;
}

}  // namespace

Expected<KeptStop> KeptStop::create(const service::Config& config, const std::string& hand) {
  std::filesystem::path folder = config.path("safety.state");
  if (folder.empty()) folder = state_directory();
  if (folder.empty()) return fail("names no folder, and there is no home", "safety.state");
  std::error_code code;
  std::filesystem::create_directories(folder, code);
  if (code) return fail(code.message(), folder.string());
  if (::access(folder.c_str(), R_OK | W_OK | X_OK) != 0)
    return fail(std::strerror(errno), folder.string());
  return KeptStop(folder / fmt::format("stop_{}_{}_{}.json", config.integer("lab.domain"),
                                       spelt(config.text("lab.rig")), spelt(hand)),
                  hand);
}

std::optional<gate::CommandGate::Stop> KeptStop::recall() const {
  std::error_code code;
  if (!std::filesystem::exists(file_, code) && !code) return std::nullopt;
  const auto text = read_file(file_);
  const auto record =
      text ? audit::parse(text->substr(0, text->find('\n'))) : tl::unexpected(text.error());
  if (record) return gate::CommandGate::Stop{record->who, record->what, record->time};
  return gate::CommandGate::Stop{"a stop that was kept", "it cannot be read: " + file_.string(),
                                 process_now()};
}

Expected<void> KeptStop::keep(const gate::CommandGate::Stop& stop) const {
  return write_file(
      file_, audit::to_line({stop.since, hand_, audit::Event::stop, stop.by, stop.reason}) + "\n");
}

Expected<void> KeptStop::forget() const {
  std::error_code code;
  std::filesystem::remove(file_, code);
  if (code) return fail(code.message(), file_.string());
  return {};
}

}  // namespace prehend::robot
