// Damaged lines of an audit log: a reason, or a record that is the same when it is written and read
// again.
#include "common/audit/record.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"

using namespace prehend;
using namespace prehend::audit;

int main(int argc, char** argv) {
  fuzz::Fuzzer fuzzer;
  const Time time = from_ns(1'700'000'000'123'456'789);
  for (const auto& row : event_names) {
    fuzzer.seeds.push_back(to_line({time, "hand", row.value, "", ""}));
    fuzzer.seeds.push_back(
        to_line({time, "hand", row.value, "mapping@host/1", "a \"reason\", ü", 12}));
  }
  fuzzer.long_round = 1'000'000;
  fuzzer.mutate = [](Random& random, std::string line) {
    return random.index(3) == 0 ? fuzz::mutate_number(random, std::move(line))
                                : fuzz::mutate_bytes(random, std::move(line));
  };
  fuzzer.target = [](const std::string& text) {
    const auto record = parse(text);
    fuzz::require(record || !record.error().what.empty(), "refused without a reason");
    if (!record) return false;
    const auto again = parse(to_line(*record));
    fuzz::require(again && again->time == record->time && again->event == record->event &&
                      again->who == record->who && again->what == record->what &&
                      again->hand == record->hand && again->count == record->count,
                  "not the same when it is read again");
    return true;
  };
  return fuzz::run(fuzzer, argc, argv);
}
