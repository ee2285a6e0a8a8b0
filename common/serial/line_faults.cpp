#include "common/serial/line_faults.hpp"

#include <utility>

namespace prehend::serial {

std::string spoil(std::string record, const LineFaults& faults, Random& random) {
  if (record.empty()) return record;
  if (random.uniform() < faults.drop_bytes) record.erase(random.index(record.size()), 1);
  if (record.size() > 1 && random.uniform() < faults.swap_bytes) {
    const std::size_t i = random.index(record.size() - 1);
    std::swap(record[i], record[i + 1]);
  }
  std::string foreign;
  if (random.uniform() < faults.garbage)
    for (std::size_t n = 1 + random.index(20); n > 0; --n)
      foreign.push_back(static_cast<char>(random.bits() & 0xff));
  return foreign + record;
}

bool within(Duration now, double begin, double length) {
  const double t = to_seconds(now);
  return begin >= 0 && t >= begin && t < begin + length;
}

}  // namespace prehend::serial
