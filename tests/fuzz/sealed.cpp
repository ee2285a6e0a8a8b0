#include "tests/fuzz/sealed.hpp"

#include "common/proto/sealed_file.hpp"
#include "tests/fuzz/mutation.hpp"

namespace prehend::fuzz {

std::string mutate_sealed(Random& random, std::string_view kind, std::string file) {
  if (random.index(2) == 0) return mutate_bytes(random, std::move(file));
  const auto content = proto::unseal(file, kind);
  require(content.has_value(), "a good input is not sealed");
  return proto::seal(kind, mutate_bytes(random, *content));
}

void require_intact(const std::string& file, std::string_view kind) {
  const auto content = proto::unseal(file, kind);
  require(content && proto::seal(kind, *content) == file, "altered, and yet accepted");
}

}  // namespace prehend::fuzz
