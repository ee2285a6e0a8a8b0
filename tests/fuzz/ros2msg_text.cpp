// A damaged ros2msg schema: refused with a reason, or a type by which bytes are decoded or refused.
#include "common/recording/types/schema_text.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"
#include "tests/fuzz/type_texts.hpp"

using namespace prehend;

int main(int argc, char** argv) {
  fuzz::Fuzzer fuzzer;
  const recording::types::Library contract = fuzz::contract();
  for (const auto& [name, type] : contract.structures())
    fuzzer.seeds.push_back(recording::types::ros2msg(*type));
  fuzzer.seeds.push_back(
      "std_msgs/Header header\nstring[] name   # joints\nuint8 FLAG = 3\nstring<=5 note \"x\"\n"
      "float32[3] fixed\nint32[<=4] few\n================\nMSG: std_msgs/Header\n"
      "builtin_interfaces/Time stamp\nstring frame_id\n================\n"
      "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n");
  fuzzer.mutate = [](Random& random, std::string text) {
    return fuzz::mutate_type_text(random, std::move(text),
                                  {"\nMSG: a/B\n", "a/B c\n", "[0]", "[<=9]", "[]", "<=3", "#"});
  };
  fuzzer.target = [](const std::string& text) {
    recording::types::Library library;
    const auto type = recording::types::parse_ros2msg("a/msg/A", text, library);
    fuzz::require(type || !type.error().what.empty(), "refused without a reason");
    if (!type) return false;
    fuzz::decode_some(**type);
    return true;
  };
  return fuzz::run(fuzzer, argc, argv);
}
