#include "common/web/site.hpp"

#include <algorithm>

namespace prehend::web {
namespace {

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

}  // namespace

std::string Request::field(std::string_view name) const {
  std::string joined;
  bool found = false;
  for (const auto& [own, value] : fields) {
    if (!std::ranges::equal(own, name, {}, lower, lower)) continue;
    if (std::exchange(found, true)) joined += ',';
    joined += value;
  }
  return joined;
}

Answer plain(int status, std::string line) {
  return {status, "text/plain; charset=utf-8", std::move(line) + "\n"};
}

}  // namespace prehend::web
