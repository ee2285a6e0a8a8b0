#include "services/demonstration/tools/demonstration/commands.hpp"

int main(int argc, char** argv) {
  using namespace prehend::demonstration;
  prehend::tool::Program program("demonstration", "Which grasp does a hand show?");
  add_train(program);
  add_evaluate(program);
  add_draw(program);
  add_show(program);
  return program.run(argc, argv);
}
