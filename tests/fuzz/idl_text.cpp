// A damaged IDL text: refused with a reason, or types that can be described to others, whose
// description gives the same types again, and by which bytes are decoded or refused.
#include "common/recording/types/idl.hpp"
#include "common/recording/types/schema_text.hpp"
#include "common/recording/types/value.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"
#include "tests/fuzz/type_texts.hpp"

using namespace prehend;

namespace {

bool use(const std::string& text) {
  recording::types::Library library;
  const auto parsed = recording::types::parse_idl(text, "fuzz", library);
  fuzz::require(parsed || !parsed.error().what.empty(), "refused without a reason");
  if (!parsed) return false;
  for (const auto& [name, type] : library.structures()) {
    recording::types::Library again;
    const std::string described = recording::types::omgidl(*type);
    const auto done = recording::types::parse_idl(described, "again", again);
    fuzz::require(done.has_value(), "its own description is refused: " + described);
    const recording::types::Structure* same = again.find(name);
    fuzz::require(same && recording::types::omgidl(*same) == described,
                  "another type: " + described);
    (void)recording::types::ros2msg(*type);
    fuzz::decode_some(*type);
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  fuzz::Fuzzer fuzzer;
  const recording::types::Library contract = fuzz::contract();
  for (const auto& [name, type] : contract.structures()) {
    fuzzer.seeds.push_back(*type->source);
    fuzzer.seeds.push_back(recording::types::omgidl(*type));
  }
  fuzzer.seeds.push_back(
      "module a { const long n = 3; typedef sequence<double, n> Row; enum E { @value(4) P, Q };\n"
      "module b { @final struct S { Row row; long grid[2][n]; ::a::E e; string<5> u, w; }; }; };");
  fuzzer.mutate = [](Random& random, std::string text) {
    return fuzz::mutate_type_text(
        random, std::move(text),
        {"module a {", "struct S {", "sequence<", "typedef ", "@value(", "[9]", "::"});
  };
  fuzzer.target = use;
  return fuzz::run(fuzzer, argc, argv);
}
