#pragma once

#include <filesystem>
#include <prehend/base/error.hpp>
#include <prehend/base/time.hpp>
#include <string>
#include <string_view>

namespace prehend::glove {

/// The far end of a serial line made of software: a program opens path() as its port. It may open
/// and close it as often as it likes.
class PseudoTerminal {
 public:
  /// `link` becomes a symbolic link to the terminal (replacing a link, but no other file); empty:
  /// none. Both go with this object.
  static Expected<PseudoTerminal> open(const std::filesystem::path& link);
  PseudoTerminal(PseudoTerminal&& other) noexcept;
  PseudoTerminal& operator=(PseudoTerminal&&) = delete;
  ~PseudoTerminal();

  const std::string& path() const { return path_; }
  /// What the program wrote; waits for it at most that long.
  std::string read(Duration timeout);
  /// Bytes that find no room, because nobody reads, are lost as on a real line.
  void write(std::string_view bytes);

 private:
  PseudoTerminal() = default;
  int master_ = -1;
  int slave_ = -1;  // kept open, so that the line survives the program's closing it
  std::string path_;
  std::filesystem::path link_;
};

}  // namespace prehend::glove
