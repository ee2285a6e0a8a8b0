// A damaged columns.toml: refused with a reason, or columns of which each has a topic.
#include "services/recorder/tools/dataset/columns_file.hpp"

#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"
#include "tests/support/foreign/foreign.hpp"

using namespace prehend;

int main(int argc, char** argv) {
  fuzz::Fuzzer fuzzer;
  for (const char* episodes :
       {"", "episodes = {gap = 2.5}\n", "episodes = {topic = \"/run\", field = \"data[1].x\"}\n"})
    fuzzer.seeds.push_back(test::columns_of_recording(true, episodes));
  fuzzer.mutate = [](Random& random, std::string text) {
    return fuzz::mutate_text(random, std::move(text), fuzz::mutate_lines);
  };
  fuzzer.target = [](const std::string& text) {
    const auto read = recorder::dataset::parse_columns(text, "columns.toml");
    fuzz::require(read || !read.error().what.empty(), "refused without a reason");
    if (!read) return false;
    bool state = false, action = false;
    for (const auto& each : read->columns) {
      fuzz::require(!each.topic.empty() && !each.name.empty(), "a column of no topic");
      state = state || each.role == recorder::dataset::Role::state;
      action = action || each.role == recorder::dataset::Role::action;
    }
    fuzz::require(state && action, "neither state nor action");
    fuzz::require(read->gap >= 0 && read->gap <= 1e6, "a gap that is none");
    return true;
  };
  return fuzz::run(fuzzer, argc, argv);
}
