#include "common/ros2/cdr.hpp"

namespace prehend::ros2 {
namespace {

constexpr std::int64_t second = 1'000'000'000;

}  // namespace

void CdrWriter::put(std::string_view text) {
  put(static_cast<std::uint32_t>(text.size() + 1));
  bytes_.insert(bytes_.end(), text.begin(), text.end());
  bytes_.push_back(0);
}

void CdrWriter::stamp(std::int64_t ns) {
  const std::int64_t behind = ((ns % second) + second) % second;
  put(static_cast<std::int32_t>((ns - behind) / second));
  put(static_cast<std::uint32_t>(behind));
}

void CdrWriter::put(const Pose& X) {
  const Eigen::Vector3d p = X.translation();
  const Eigen::Quaterniond q(X.rotation());
  for (const double value : {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()}) put(value);
}

/// Two bytes say how the rest is written: 0 is CDR of the one byte order, 1 of the other.
CdrReader::CdrReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {
  if (bytes.size() < encapsulation) return;
  good_ = bytes[0] == 0 && bytes[1] <= 1;
  little_ = bytes[1] == 1;
}

template <class Number>
Number CdrReader::number() {
  const std::size_t over = (at_ - encapsulation) % sizeof(Number);
  const std::size_t gap = over == 0 ? 0 : sizeof(Number) - over;
  if (!good_ || left() < gap + sizeof(Number)) {
    good_ = false;
    return 0;
  }
  at_ += gap;
  Number value = 0;
  for (std::size_t i = 0; i < sizeof(Number); ++i) {
    const std::size_t shift = 8 * (little_ ? i : sizeof(Number) - 1 - i);
    value |= static_cast<Number>(bytes_[at_ + i]) << shift;
  }
  at_ += sizeof(Number);
  return value;
}

std::uint8_t CdrReader::byte() {
  return number<std::uint8_t>();
}

std::uint32_t CdrReader::count() {
  return number<std::uint32_t>();
}

double CdrReader::real() {
  return std::bit_cast<double>(number<std::uint64_t>());
}

std::uint32_t CdrReader::length(std::size_t smallest) {
  const std::uint32_t items = count();
  if (good_ && items <= left() / smallest) return items;
  good_ = false;
  return 0;
}

/// With its zero; some write none behind an empty text.
std::string CdrReader::text() {
  const std::uint32_t size = length(1);
  if (size == 0) return {};
  const auto begin = bytes_.begin() + static_cast<std::ptrdiff_t>(at_);
  at_ += size;
  if (bytes_[at_ - 1] != 0) good_ = false;
  return good_ ? std::string(begin, begin + size - 1) : std::string();
}

std::vector<double> CdrReader::reals() {
  std::vector<double> made(length(sizeof(double)));
  for (double& value : made) value = real();
  return good_ ? made : std::vector<double>();
}

std::vector<std::uint8_t> CdrReader::bytes() {
  const std::uint32_t size = length(1);
  if (!good_) return {};
  const auto begin = bytes_.begin() + static_cast<std::ptrdiff_t>(at_);
  at_ += size;
  return {begin, begin + size};
}

std::vector<std::string> CdrReader::texts() {
  std::vector<std::string> made(length(sizeof(std::uint32_t)));
  for (std::string& value : made) value = text();
  return good_ ? made : std::vector<std::string>();
}

std::int64_t CdrReader::stamp() {
  const auto whole = static_cast<std::int32_t>(count());
  return whole * second + count();
}

std::pair<Eigen::Vector3d, Eigen::Quaterniond> CdrReader::pose() {
  std::array<double, 7> values{};
  for (double& value : values) value = real();
  const auto& [x, y, z, qx, qy, qz, qw] = values;
  return {{x, y, z}, {qw, qx, qy, qz}};
}

}  // namespace prehend::ros2
