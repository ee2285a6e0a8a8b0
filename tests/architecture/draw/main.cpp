// draw_architecture: prints the drawing of the house; with --write puts it into ARCHITECTURE.md,
// and makes the index of the decisions.
#include <fstream>
#include <iostream>
#include <iterator>
#include <string_view>

#include "tests/architecture/decisions.hpp"
#include "tests/architecture/drawing.hpp"
#include "tests/support/paths/paths.hpp"

int main(int argc, char** argv) {
  using namespace prehend::architecture;
  const std::filesystem::path root = prehend::test::in_sources("");
  const House house = read_house(root);
  const std::string drawn = drawing(house);
  if (argc == 1) {
    std::cout << drawn;
    return 0;
  }
  if (argc != 2 || std::string_view(argv[1]) != "--write") {
    std::cerr << "usage: draw_architecture [--write]\n";
    return 2;
  }
  std::ifstream in(root / "ARCHITECTURE.md");
  const std::string page{std::istreambuf_iterator<char>(in), {}};
  std::ofstream out(root / "ARCHITECTURE.md");
  out << with_drawing(page, drawn) << std::flush;
  std::ofstream index(root / decisions_page);
  index << decisions(house) << std::flush;
  return out && index ? 0 : 3;
}
