#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace prehend {

/// Exit codes of every program.
enum Exit : int {
  exit_done = 0,
  exit_no = 1,         // the answer is no
  exit_wrong_use = 2,  // arguments or configuration
  exit_broken = 3      // the environment: something is missing or does not work
};

/// An expected failure: what is wrong, where, and what to do about it. Each is one short clause.
struct Error {
  std::string what;
  std::string where;
  std::string hint;
  Exit exit = exit_broken;  // of a program that ends with it

  /// «where: what (hint)», on one line.
  std::string message() const {
    std::string text = where.empty() ? what : where + ": " + what;
    if (!hint.empty()) text += " (" + hint + ")";
    return text;
  }
};

template <class T>
using Expected = tl::expected<T, Error>;

/// The failing return value of any function that returns an Expected.
inline tl::unexpected<Error> fail(std::string what, std::string where = {}, std::string hint = {},
                                  Exit exit = exit_broken) {
  return tl::unexpected<Error>(Error{std::move(what), std::move(where), std::move(hint), exit});
}

/// The same where the user asked for something that is not possible.
inline tl::unexpected<Error> wrong_use(std::string what, std::string where = {},
                                       std::string hint = {}) {
  return fail(std::move(what), std::move(where), std::move(hint), exit_wrong_use);
}

}  // namespace prehend
