#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace prehend {

/// An expected failure: what is wrong, where, and what to do about it. Each is one short clause.
struct Error {
  std::string what;
  std::string where;
  std::string mend;

  /// «where: what (mend)», on one line.
  std::string message() const {
    std::string text = where.empty() ? what : where + ": " + what;
    if (!mend.empty()) text += " (" + mend + ")";
    return text;
  }
};

template <class T>
using Expected = tl::expected<T, Error>;

/// The failing return value of any function that returns an Expected.
inline tl::unexpected<Error> fail(std::string what, std::string where = {}, std::string mend = {}) {
  return tl::unexpected<Error>(Error{std::move(what), std::move(where), std::move(mend)});
}

}  // namespace prehend
