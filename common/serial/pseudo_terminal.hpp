#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "common/serial/plug.hpp"

namespace prehend::serial {

/// The far end of a serial line made of software: a program opens path() as its port. It may open
/// and close it as often as it likes.
class PseudoTerminal final : public Plug {
 public:
  /// `link` becomes a symbolic link to the terminal (replacing a link, but no other file); empty:
  /// none. Both go with this object.
  static Expected<PseudoTerminal> open(const std::filesystem::path& link);
  PseudoTerminal(PseudoTerminal&& other) noexcept;
  PseudoTerminal& operator=(PseudoTerminal&&) = delete;
  ~PseudoTerminal() override;

  const std::string& path() const { return path_; }
  std::string read(Duration timeout) override;
  void write(std::string_view bytes) override;
  /// The link, or else the terminal.
  std::string where() const override { return link_.empty() ? path_ : link_.string(); }

 private:
  PseudoTerminal() = default;
  int master_ = -1;
  int slave_ = -1;  // kept open, so that the line survives the program's closing it
  std::string path_;
  std::filesystem::path link_;
};

}  // namespace prehend::serial
