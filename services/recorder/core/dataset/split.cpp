#include "services/recorder/core/dataset/split.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numeric>

#include "common/base/finite_number.hpp"
#include "common/base/random.hpp"

namespace prehend::recorder::dataset {
namespace {

constexpr std::size_t max_parts = 16;
constexpr const char* how = "as train=0.8,valid=0.2: names, and shares that are 1 together";

bool is_name(const std::string& text) {
  if (text == "success" || text == "failure") return false;  // parts of what was judged
  return !text.empty() && text.size() <= 32 && std::ranges::all_of(text, [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_';
  });
}

/// How many episodes each part gets.
std::vector<std::size_t> sizes_of(const Shares& shares, std::size_t episodes) {
  std::vector<std::size_t> sizes;
  double sum = 0;
  std::size_t given = 0;
  for (const auto& [name, share] : shares) {
    sum += share;
    const auto until = static_cast<std::size_t>(std::lround(sum * static_cast<double>(episodes)));
    sizes.push_back(until - given);
    given = until;
  }
  for (std::size_t& size : sizes)
    if (size == 0) {
      --*std::ranges::max_element(sizes);
      size = 1;
    }
  return sizes;
}

}  // namespace

Expected<Shares> parse_split(const std::string& text) {
  Shares shares;
  double sum = 0;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string part = text.substr(begin, end - begin);
    begin = end + 1;
    const std::size_t equals = part.find('=');
    const std::string name = part.substr(0, equals);
    const auto share =
        equals == std::string::npos ? std::nullopt : finite_number(part.substr(equals + 1));
    const bool twice = std::ranges::any_of(shares, [&](const auto& s) { return s.first == name; });
    if (!is_name(name) || twice || !share || *share <= 0 || *share > 1)
      return wrong_use(fmt::format("«{}» is no part of a split", part), "--split", how);
    shares.emplace_back(name, *share);
    sum += *share;
  }
  if (shares.size() > max_parts || std::abs(sum - 1) > 1e-6)
    return wrong_use(fmt::format("its shares are {:g} together", sum), "--split", how);
  return shares;
}

Expected<std::vector<std::size_t>> draw_split(const Shares& shares, std::size_t episodes,
                                              std::uint64_t seed) {
  if (episodes < shares.size())
    return wrong_use(fmt::format("{} parts of {} episodes", shares.size(), episodes), "--split",
                     "each part needs an episode: record more, or name fewer parts");
  std::vector<std::size_t> order(episodes);
  std::iota(order.begin(), order.end(), std::size_t{0});
  Random random(seed * 0x9E3779B97F4A7C15ULL + 1);
  for (std::size_t i = episodes; i > 1; --i) std::swap(order[i - 1], order[random.index(i)]);
  std::vector<std::size_t> part(episodes);
  std::size_t next = 0;
  const auto sizes = sizes_of(shares, episodes);
  for (std::size_t k = 0; k < sizes.size(); ++k)
    for (std::size_t n = 0; n < sizes[k]; ++n) part[order[next++]] = k;
  return part;
}

}  // namespace prehend::recorder::dataset
