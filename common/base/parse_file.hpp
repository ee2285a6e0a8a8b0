#pragma once

#include <filesystem>

#include "common/base/error.hpp"
#include "common/base/file_text.hpp"

namespace prehend {

/// What `parse` makes of the text of a file. A failure says in which file, and where in it.
template <class Parse>
auto parse_file(const std::filesystem::path& file, Parse parse) -> decltype(parse(std::string())) {
  const auto text = read_file(file);
  if (!text) return tl::unexpected(text.error());
  auto made = parse(*text);
  if (!made)
    return fail(made.error().what,
                file.string() + (made.error().where.empty() ? "" : ", ") + made.error().where,
                made.error().hint);
  return made;
}

}  // namespace prehend
