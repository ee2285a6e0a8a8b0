// Damaged tasks: a broken seal is never accepted, and what a good seal holds is refused with a
// reason or is a sound task that can be shown.
#include <google/protobuf/stubs/logging.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "common/tasks/files/task_file.hpp"
#include "tests/fuzz/sealed.hpp"

using namespace prehend;
using namespace prehend::tasks;

int main(int argc, char** argv) {
  const auto path = std::filesystem::temp_directory_path() /
                    ("fuzz-task-" + std::to_string(::getpid()) + ".task");
  google::protobuf::SetLogHandler(nullptr);  // it would report every broken name
  fuzz::Fuzzer fuzzer;
  fuzzer.long_round = 10000;
  for (const std::size_t steps : {1, 2, 5}) {
    TaskModel task{"lay the table", 3, std::vector<Step>(steps)};
    for (std::size_t i = 0; i < steps; ++i) {
      task.steps[i].object = "object " + std::to_string(i);
      task.steps[i].X_RO = make_pose({0.1, 0.2, 0.05});
      if (i > 0) task.steps[i].after = {i - 1};
    }
    ShownStep shown{.object = "object 0", .grasp = "tripod"};
    shown.X_WR["object 1"] = make_pose({0.3, 0.2, 0.05});
    const TaskRecord record{task, {{shown, shown}}, {{from_ns(7), "barrett", true, ""}}};
    fuzz::require(save_record(path, record).has_value(), "no seed");
    fuzzer.seeds.push_back(fuzz::read_file(path.string()));
  }
  fuzzer.mutate = [](Random& random, std::string file) {
    return fuzz::mutate_sealed(random, "task", std::move(file));
  };
  fuzzer.target = [&](const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
    const auto task = load_task(path);
    fuzz::require(task || !task.error().what.empty(), "refused without a reason");
    if (!task) return false;
    fuzz::require_intact(bytes, "task");
    fuzz::require(check(*task).has_value() && order_of(*task)->size() == task->steps.size(),
                  "accepted, and yet not good");
    fuzz::require(to_toml(*task).find("[[step]]") != std::string::npos, "cannot be shown");
    return true;
  };
  const int result = fuzz::run(fuzzer, argc, argv);
  std::filesystem::remove(path);
  return result;
}
