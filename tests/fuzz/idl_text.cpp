// A damaged IDL text: refused with a reason, or types that can be described to others, whose
// description gives the same types again, and by which bytes are decoded or refused.
#include <prehend/types/idl.hpp>
#include <prehend/types/schema_text.hpp>
#include <prehend/types/value.hpp>

#include "fuzz.hpp"
#include "mutation.hpp"
#include "type_texts.hpp"

using namespace prehend;

namespace {

bool use(const std::string& text) {
  types::Library library;
  const auto parsed = types::parse_idl(text, "fuzz", library);
  fuzz::require(parsed || !parsed.error().what.empty(), "refused without a reason");
  if (!parsed) return false;
  for (const auto& [name, type] : library.structures()) {
    types::Library again;
    const std::string described = types::omgidl(*type);
    const auto done = types::parse_idl(described, "again", again);
    fuzz::require(done.has_value(), "its own description is refused: " + described);
    const types::Structure* same = again.find(name);
    fuzz::require(same && types::omgidl(*same) == described, "another type: " + described);
    (void)types::ros2msg(*type);
    fuzz::decode_some(*type);
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  fuzz::Fuzzer fuzzer;
  const types::Library contract = fuzz::contract();
  for (const auto& [name, type] : contract.structures()) {
    fuzzer.seeds.push_back(*type->source);
    fuzzer.seeds.push_back(types::omgidl(*type));
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
