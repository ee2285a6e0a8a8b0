#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "common/base/error.hpp"
#include "common/service/arguments.hpp"
#include "services/glove/core/frame.hpp"

namespace prehend::glove {

/// A glove's frames for a tool: those that come on glove/frame, those of a device that the tool
/// drives itself, or those of a recording.
class FrameInput {
 public:
  /// Takes part in the lab; hears the glove `glove.name`.
  static Expected<FrameInput> live(const service::Config& config);
  /// Drives the configured device, which no service may be doing meanwhile.
  static Expected<FrameInput> driven(const service::Config& config);
  /// A recording of topics (MCAP) with glove/frame, or a hand recording (CSV).
  static Expected<FrameInput> recorded(const std::filesystem::path& file);
  FrameInput(FrameInput&&) noexcept;
  FrameInput& operator=(FrameInput&&) noexcept;
  ~FrameInput();

  /// What has come since the last call; of a recording everything.
  std::vector<Frame> poll();
  bool live() const;

 private:
  struct State;
  explicit FrameInput(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// The last key that was entered on standard input, 0 where there is none. Does not wait.
char entered_key();

}  // namespace prehend::glove
