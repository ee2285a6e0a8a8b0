#include "common/recording/layout/older_types.hpp"

namespace prehend::recording {

std::string_view current_type(std::string_view type) {
  if (type == "prehend::v1::HandCommand") return "prehend::v2::HandCommand";  // has `effort`
  if (type == "prehend::v1::GraspCandidates")
    return "prehend::v2::GraspCandidates";  // has `follow_through`
  return type;
}

void make_current(std::vector<std::uint8_t>& payload) {
  constexpr std::size_t header = 4, length = 4;  // bytes
  if (payload.size() < header) return;           // is refused by who decodes it
  payload[3] &= 0xfc;                            // how many bytes at the end are padding
  const std::size_t aligned = (payload.size() + length - 1) / length * length;
  payload.resize(aligned + length, 0);
}

}  // namespace prehend::recording
