#include "common/recording/types/stamps.hpp"

#include <algorithm>
#include <cstring>

namespace prehend::recording::types {
namespace {

/// Walks through a message (XCDR1, little-endian) and notes where its stamps are.
class Walk {
 public:
  explicit Walk(const std::vector<std::uint8_t>& message) : message_(message) {}

  bool structure(const Structure& type) {
    for (const Field& field : type.fields) {
      std::uint32_t count = 1;
      if (field.type.many == Type::Many::array) count = field.type.count;
      if (field.type.many == Type::Many::sequence) count = length();
      const bool stamp = field.name.ends_with("_ns") &&
                         (field.type.kind == Kind::int64 || field.type.kind == Kind::uint64);
      if (field.type.kind == Kind::uint8)  // pictures
        pass(count);
      else
        for (std::uint32_t i = 0; good_ && i < count; ++i) one(field.type, stamp);
      if (!good_) return false;
    }
    return true;
  }
  const std::vector<std::size_t>& stamps() const { return stamps_; }

 private:
  void one(const Type& type, bool stamp) {
    switch (type.kind) {
      case Kind::boolean:
      case Kind::character:
      case Kind::int8:
      case Kind::uint8:
        return skip(1);
      case Kind::int16:
      case Kind::uint16:
        return skip(2);
      case Kind::int32:
      case Kind::uint32:
      case Kind::float32:
      case Kind::enumeration:
        return skip(4);
      case Kind::int64:
      case Kind::uint64:
        skip(8);
        if (good_ && stamp) stamps_.push_back(at_ - 8);
        return;
      case Kind::float64:
        return skip(8);
      case Kind::string:
        return pass(length());
      case Kind::structure:
        good_ = structure(*type.structure) && good_;
    }
  }
  void pass(std::size_t size) {
    good_ = good_ && size <= message_.size() - at_;
    if (good_) at_ += size;
  }
  /// Alignment counts from behind the encapsulation.
  void skip(std::size_t size) {
    at_ = 4 + (at_ - 4 + size - 1) / size * size + size;
    good_ = good_ && at_ <= message_.size();
  }
  std::uint32_t length() {
    skip(4);
    std::uint32_t value = 0;
    if (good_) std::memcpy(&value, message_.data() + at_ - 4, 4);
    return value;
  }

  const std::vector<std::uint8_t>& message_;
  std::size_t at_ = 4;
  bool good_ = true;
  std::vector<std::size_t> stamps_;
};

}  // namespace

bool move_stamps(const Structure& type, const std::function<std::int64_t(std::int64_t)>& moved,
                 std::vector<std::uint8_t>& message) {
  if (message.size() < 4 || message[1] != 1) return false;  // CDR_LE is all that our writers make
  Walk walk(message);
  if (!walk.structure(type)) return false;
  for (const std::size_t at : walk.stamps()) {
    std::int64_t stamp = 0;
    std::memcpy(&stamp, message.data() + at, 8);
    if (stamp != 0) stamp = moved(stamp);
    std::memcpy(message.data() + at, &stamp, 8);
  }
  return true;
}

}  // namespace prehend::recording::types
