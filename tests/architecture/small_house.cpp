#include "tests/architecture/small_house.hpp"

#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <utility>

namespace prehend::architecture {
namespace {

constexpr std::array small_edges{Edge{"common/model", "common/base"}};
constexpr std::array small_cores{
    Exception{"services/arm/core/joint.cpp", "cstdio", "an exception that is used"}};
constexpr std::array small_functions{
    Exception{"services/arm/core/joint.cpp", "listed()", "a long function that is known"}};
constexpr std::array small_ends{
    Exception{"common/base/error.cpp", "_Exit", "an end that is known"}};
constexpr std::array small_commands{
    Exception{"services/arm/tools/main.cpp", "add_wave", "a command that is known"}};
constexpr std::array small_targets{
    Exception{"common/model/CMakeLists.txt", "made_by_hand", "a target that is known"}};

constexpr std::array small_pages{
    Exception{"services/arm/README.md", "## Joints", "a table that is read by its rows"}};

constexpr std::array small_retired{Retired{"RightOfWay", "FingerCollisionLimiter"},
                                   Retired{"Wrist", "ArmEnd", "arm"}, Retired{"figures", "stats"}};

std::string header(const std::string& space, const std::string& includes = "",
                   const std::string& code = "") {
  return "#pragma once\n" + includes + "namespace " + space + " {\n" + code + "}\n";
}

std::string source(const std::string& space, const std::string& includes,
                   const std::string& code = "") {
  return includes + "namespace " + space + " {\n" + code + "}\n";
}

std::string include(const std::string& path) {
  return "#include \"" + path + "\"\n";
}

std::string long_function(const std::string& name, const std::string& indent = "",
                          const std::string& end = "}") {
  std::string text = indent + name + " {\n" + indent + "  int sum = 0;\n";
  for (int i = 0; i < 60; ++i) text += indent + "  ++sum;\n";
  return text + indent + "  return sum;\n" + indent + end + "\n";
}

std::string words(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += "word ";
  return text + "\n";
}

// Has 1600 words: 251 in a section that is listed, six times 223, 11, and what is no word.
std::string arm_page(int more_words = 0, const std::string& end = {}) {
  std::string page = "## Joints\n" + words(250);
  for (int i = 0; i < 6; ++i) page += "### A [part](../leg), «also» here\n| | - |\n" + words(219);
  return page + words(11 + more_words) + "```sh\n# no heading\n" + words(300) + "```\n" + end;
}

const std::string joint_includes = include("services/arm/core/joint.hpp") + "#include <cstdio>\n";
const std::string joint_code = long_function("int listed()") + "// Long: a table in words.\n" +
                               long_function("int says_why()");
const std::string main_includes = include("services/arm/tools/commands.hpp");
const std::string main_code =
    "void add_wave(tool::Program& program) {\n  program;\n}\nint main() {\n  exit(2);\n}\n";
const std::string common_include = include("common/base/error.hpp");

// Names of files that change in more than one break.
const std::string joint_header = "services/arm/core/joint.hpp";
const std::string joint_source = "services/arm/core/joint.cpp";
const std::string joint_build = "services/arm/core/CMakeLists.txt";
const std::string error_source = "common/base/error.cpp";
const std::string service_header = "services/arm/service/service.hpp";
const std::string service_source = "services/arm/service/service.cpp";
const std::string service_build = "services/arm/service/CMakeLists.txt";
const std::string model_build = "common/model/CMakeLists.txt";
const std::string arm_readme = "services/arm/README.md";
const std::string arm_test = "tests/unit/arm_test.cpp";
const std::string arm_test_include = include("tests/unit/help.hpp");
const std::string tool_main = "services/arm/tools/main.cpp";
const std::string tool_build = "services/arm/tools/CMakeLists.txt";

std::string joint(const std::string& more_includes, const std::string& more_code = "") {
  return source("prehend::arm", joint_includes + more_includes, joint_code + more_code);
}

std::string error(const std::string& more_includes, const std::string& more_code = "") {
  return source("prehend", common_include + more_includes,
                "void stop() {\n  std::_Exit(3);\n}\n" + more_code);
}

std::string service(const std::string& more_includes) {
  return source("prehend::arm", include(service_header) + common_include + more_includes);
}

using Breaks = std::vector<Break>;

void add(Breaks& all, Breaks more) {
  all.insert(all.end(), more.begin(), more.end());
}

Breaks include_breaks() {
  return {
      {"includes",
       "a header that is not there",
       error_source,
       {{error_source, error(include("common/base/none.hpp"))}}},
      {"includes",
       "a path that climbs",
       error_source,
       {{error_source, error(include("../model/hand.hpp"))}}},
      {"includes",
       "the old link farm",
       error_source,
       {{error_source, error("#include <prehend/base.hpp>\n")}}},
      {"includes",
       "our own header in <>",
       error_source,
       {{error_source, error("#include <common/base/error.hpp>\n")}}},
      {"includes",
       "a header without #pragma once",
       joint_header,
       {{joint_header, include("common/model/hand.hpp") + "namespace prehend::arm {\n}\n"}}},
      {"includes",
       "a header that nobody includes",
       "common/base/lonely.hpp",
       {{"common/base/lonely.hpp", header("prehend")}}},
  };
}

Breaks edge_breaks() {
  return {
      {"edges",
       "an edge that is not agreed on, and a cycle",
       error_source,
       {{error_source, error(include("common/model/hand.hpp"))},
        {"common/base/CMakeLists.txt", "prehend_library(PRIVATE common_model)\n"}}},
      {"edges",
       "an edge that is no longer there",
       std::string(agreed_file),
       {{"common/model/hand.hpp", header("prehend::model")},
        {model_build, "prehend_library()\nadd_library(made_by_hand)\n"},
        {service_build,
         "prehend_library(LINK services_arm_core common_base)\nprehend_program(prehend-arm)\n"}}},
      {"edges",
       "common that knows a service",
       error_source,
       {{error_source, error(include("services/leg/core/knee.hpp"))},
        {"common/base/CMakeLists.txt", "prehend_library(LINK services_leg_core)\n"}}},
      {"edges",
       "a service that knows another",
       joint_source,
       {{joint_source, joint(include("services/leg/core/knee.hpp"))},
        {joint_build, "prehend_library(LINK common_model PRIVATE services_leg_core)\n"}}},
      {"edges",
       "product code that knows tests",
       joint_source,
       {{joint_source, joint(include("tests/unit/help.hpp"))}}},
      {"edges",
       "folders of a service that need each other",
       "services/arm/core/joint.cpp",
       {{joint_source, joint(include("services/arm/core/solver/solver.hpp"))},
        {joint_build, "prehend_library(LINK common_model PRIVATE services_arm_core_solver)\n"},
        {"services/arm/core/solver/solver.hpp", header("prehend::arm", include(joint_header))},
        {"services/arm/core/solver/solver.cpp",
         source("prehend::arm", include("services/arm/core/solver/solver.hpp"))},
        {"services/arm/core/solver/CMakeLists.txt", "prehend_library(LINK services_arm_core)\n"}}},
  };
}

Breaks layer_breaks() {
  return {
      {"layers",
       "a core that knows files",
       joint_source,
       {{joint_source, joint(include("services/arm/files/store.hpp"))},
        {joint_build, "prehend_library(LINK common_model services_arm_files)\n"}}},
      {"layers",
       "a service that knows tools",
       service_source,
       {{service_source, service(include("services/arm/tools/commands.hpp"))},
        {service_build,
         "prehend_library(LINK services_arm_core services_arm_tools)\n"
         "prehend_program(prehend-arm)\n"}}},
      {"layers",
       "files that know a device",
       "services/arm/files/store.cpp",
       {{"services/arm/files/store.cpp",
         source("prehend::arm", include("services/arm/files/store.hpp") +
                                    include("services/arm/devices/motor.hpp"))},
        {"services/arm/files/CMakeLists.txt", "prehend_library(LINK services_arm_devices)\n"}}},
      {"cores", "a thread in a core", joint_source, {{joint_source, joint("#include <thread>\n")}}},
      {"cores",
       "a file in the header of a core",
       joint_header,
       {{joint_header,
         header("prehend::arm", include("common/model/hand.hpp") + "#include <fstream>\n")}}},
      {"cores",
       "DDS in a core",
       joint_source,
       {{joint_source, joint(include("idl/Robot.h"))},
        {joint_build, "prehend_library(LINK common_model idl)\n"}}},
      {"cores",
       "a core that asks for the time",
       joint_source,
       {{joint_source, joint("", "auto now() { return std::chrono::steady_clock::now(); }\n")}}},
      {"cores",
       "an exception that is not needed",
       joint_source,
       {{joint_source, source("prehend::arm", include(joint_header), joint_code)}}},
  };
}

Breaks target_breaks() {
  return {
      {"targets",
       "a header's include that comes through another target only",
       service_header,
       {{service_header,
         header("prehend::arm", include(joint_header) + include("common/model/hand.hpp"))}}},
      {"targets",
       "a source's include that no target brings",
       service_source,
       {{service_source, service(include("services/arm/files/store.hpp"))}}},
      {"targets",
       "a main.cpp's include that no target brings",
       tool_main,
       {{tool_main, main_includes + include("services/arm/files/store.hpp") + main_code}}},
      {"targets",
       "a folder without CMakeLists.txt",
       "services/leg/core/CMakeLists.txt",
       {{"services/leg/core/CMakeLists.txt", ""}}},
      {"targets",
       "a main.cpp without its program",
       tool_build,
       {{tool_build, "prehend_library(LINK services_arm_core)\n"}}},
      {"targets",
       "two programs of one main.cpp",
       tool_build,
       {{tool_build,
         "prehend_library(LINK services_arm_core)\nprehend_program(arm)\nprehend_program(leg)\n"}}},
      {"targets",
       "two libraries in a folder",
       joint_build,
       {{joint_build, "prehend_library(LINK common_model)\nprehend_library()\n"}}},
      {"targets",
       "a library with a name of its own",
       joint_build,
       {{joint_build, "prehend_library(joints LINK common_model)\n"}}},
      {"targets",
       "a link that nothing needs",
       joint_build,
       {{joint_build, "prehend_library(LINK common_model services_arm_files)\n"}}},
      {"targets",
       "a link to a target that is not there",
       joint_build,
       {{joint_build, "prehend_library(LINK common_model common_none)\n"}}},
      {"targets",
       "a target made by hand",
       joint_build,
       {{joint_build, "prehend_library(LINK common_model)\nadd_library(other other.cpp)\n"}}},
      {"services",
       "a service without a page",
       "services/leg/README.md",
       {{"services/leg/README.md", ""}}},
      {"services",
       "a folder that services do not have",
       "services/arm/helpers",
       {{"services/arm/helpers/list.toml", "x = 1\n"}}},
  };
}

Breaks code_breaks() {
  return {
      {"namespaces",
       "a namespace of another folder",
       "common/model/hand.cpp",
       {{"common/model/hand.cpp", source("prehend::model", include("common/model/hand.hpp"),
                                         "}\nnamespace prehend::dds {\n")}}},
      {"namespaces",
       "no namespace",
       "common/model/hand.cpp",
       {{"common/model/hand.cpp", include("common/model/hand.hpp")}}},
      {"programs",
       "an end in a library",
       service_source,
       {{service_source, service("") + "void end() {\n  std::exit(1);\n}\n"}}},
      {"programs",
       "another end in a library",
       joint_source,
       {{joint_source, joint("", "void end() {\n  abort();\n}\n")}}},
      {"programs",
       "an end that is listed and gone",
       error_source,
       {{error_source, source("prehend", common_include)}}},
      {"commands",
       "a command in a file of another name",
       "services/arm/tools/move.cpp",
       {{"services/arm/tools/move.cpp",
         source("prehend::arm", include("services/arm/tools/commands.hpp"),
                "void add_move(tool::Program& program,\n              int& code) {\n  "
                "program;\n}\n")}}},
      {"commands",
       "main() in a file of another name",
       "services/arm/tools/arm.cpp",
       {{"services/arm/tools/arm.cpp",
         source("prehend::arm", include("services/arm/tools/commands.hpp"), "}\nint main() {\n")}}},
  };
}

Breaks main_breaks() {
  return {
      {"mains",
       "a class beside main()",
       tool_main,
       {{tool_main, main_includes + "class Session final : public Shell {\n};\n" + main_code}}},
      {"mains",
       "a struct beside main()",
       tool_main,
       {{tool_main, main_includes + "struct Options\n{\n};\n" + main_code}}},
      {"mains",
       "a main.cpp that does more than call",
       tool_main,
       {{tool_main, main_includes + main_code + std::string(60, '\n')}}},
      {"mains",
       "a class beside the main() of a test",
       "tests/unit/domains/main.cpp",
       {{"tests/unit/domains/main.cpp", arm_test_include + "struct Lease {\n};\nint main() {}\n"}}},
  };
}

Breaks function_breaks() {
  return {
      {"functions",
       "a long function",
       arm_test,
       {{arm_test, arm_test_include + long_function("int test(\n    int number)")}}},
      {"functions",
       "a long member in its class",
       arm_test,
       {{arm_test, arm_test_include + "class Arm {\n public:\n" +
                       long_function("int turn() const", "  ") + "};\n"}}},
      {"functions",
       "a long constructor in its class",
       arm_test,
       {{arm_test, arm_test_include + "class Arm {\n public:\n" +
                       long_function("Arm()\n      : angle_{0}", "  ") + "};\n"}}},
      {"functions",
       "a long template",
       arm_test,
       {{arm_test, arm_test_include + long_function("template <class T>\nint test(T value)")}}},
      {"functions",
       "a long function of an inner namespace",
       arm_test,
       {{arm_test, arm_test_include + "namespace a {\nnamespace {\n" + long_function("int test()") +
                       "}\n}\n"}}},
      {"functions",
       "a long lambda in a function that says why it is long",
       arm_test,
       {{arm_test, arm_test_include + "// Long: a list.\nint test() {\n" +
                       long_function("const auto count = [&]", "  ", "};") + "}\n"}}},
      {"functions",
       "a long function around a lambda that says why it is long",
       arm_test,
       {{arm_test, arm_test_include + "int test() {\n  // Long: a list.\n" +
                       long_function("const auto count = [&](int x)", "  ", "};") + "}\n"}}},
      {"functions",
       "a reason of a function that is short",
       arm_test,
       {{arm_test, arm_test_include + "// Long: a list.\nint test() {\n  return 1;\n}\n"}}},
      {"functions",
       "a listed function that has become short",
       joint_source,
       {{joint_source, source("prehend::arm", joint_includes, "int listed() { return 1; }\n")}}},
  };
}

Breaks word_breaks() {
  return {
      {"words",
       "a name that was given up",
       joint_source,
       {{joint_source, joint("", "class RightOfWay;\n")}}},
      {"words",
       "a name that was given up, in a longer one",
       joint_source,
       {{joint_source, joint("", "int rest(const RightOfWayOptions& options);\n")}}},
      {"words",
       "a name that was given up, as a variable",
       joint_source,
       {{joint_source, joint("", "int a_right_of_way = 1;\n")}}},
      {"words",
       "a name that was given up in its folder",
       joint_source,
       {{joint_source, joint("", "struct LeftWrist;\n")}}},
      {"words",
       "a function whose name was given up",
       joint_source,
       {{joint_source, joint("", "Stats figures();\n")}}},
      {"words",
       "a file with a name that was given up",
       "tests/unit/right_of_way_test.cpp",
       {{"tests/unit/right_of_way_test.cpp", arm_test_include}}},
      {"words",
       "a file with a name that was given up in its folder",
       "tests/unit/arm/wrist.md",
       {{"tests/unit/arm/wrist.md", "A wrist.\n"}}},
      {"words",
       "a name that the glossary gave up and the rule does not know",
       "docs/glossary.md",
       {{"docs/glossary.md", "| Elbow | bends (was Knee) |\n"}}},
      {"words",
       "a prefix that was given up",
       arm_test,
       {{arm_test, arm_test_include + "int most_wide = 1; /* a comment */\n"}}},
  };
}

Breaks root_breaks() {
  return {{"root", "a file that an option made by mistake", "--help", {{"--help", "x\n"}}},
          {"root", "a page of its own", "NOTES.md", {{"NOTES.md", "x\n"}}},
          {"root", "a folder of its own", "attic", {{"attic/old.txt", "x\n"}}}};
}

Breaks page_breaks() {
  return {
      {"pages",
       "a link that leads nowhere",
       "README.md",
       {{"README.md", "[arm](services/arm/PAGE.md)\n"}}},
      {"pages",
       "a link to a heading that is not there",
       "README.md",
       {{"README.md", "[arm](services/arm/README.md#elbows)\n"}}},
      {"pages",
       "a link to one more heading of a name than there are",
       "README.md",
       {{"README.md", "[arm](services/arm/README.md#a-part-also-here-6)\n"}}},
      {"pages",
       "a link to a heading of its own page that is code",
       arm_readme,
       {{arm_readme, arm_page(-1, "[code](#no-heading)\n")}}},
      {"pages",
       "a link to a heading of what is no page",
       "README.md",
       {{"README.md", "[arm](services/arm/core/joint.hpp#L3)\n"}}},
      {"pages", "a page that nobody reads", arm_readme, {{arm_readme, arm_page(1)}}},
      {"pages",
       "a section that nobody reads",
       "services/leg/README.md",
       {{"services/leg/README.md", "A leg.\n## Knee\n" + words(250)}}},
      {"pages",
       "words before the first heading that nobody reads",
       "services/leg/README.md",
       {{"services/leg/README.md", words(251)}}},
      {"pages",
       "a section that has become short and is still listed",
       arm_readme,
       {{arm_readme, "## Joints\n"}}},
      {"pages",
       "a decision that is an essay",
       "docs/decisions/0001-one.md",
       {{"docs/decisions/0001-one.md", words(251)}}},
  };
}

}  // namespace

Texts small_house() {
  const std::string tool_sources = include("services/arm/tools/commands.hpp");
  return {
      {"README.md",
       "[arm](services/arm) and [the web](https://example.org/#here), `[x](y)`\n"
       "# Here\n[here](#here), [a](services/arm/README.md#joints), "
       "[b](services/arm/README.md#a-part-also-here), "
       "[c](services/arm/README.md#a-part-also-here-5)\n"},
      {"docs/glossary.md", "| ArmEnd | turns (was Wrist) |\n"},
      {"docs/decisions/0001-one.md", "[up](../../README.md) " + words(248)},
      {"common/base/error.hpp", header("prehend")},
      {error_source, error("")},
      {"common/base/CMakeLists.txt", "prehend_library(LINK Eigen3::Eigen)\n"},
      {"common/model/hand.hpp", header("prehend::model", common_include)},
      {"common/model/hand.cpp",
       source("prehend::model::detail", include("common/model/hand.hpp"),
              "const char* text = \"std::exit(1); RightOfWay\";  // abort() LearntPlace\n")},
      {model_build,
       "prehend_library(  # the model\n  LINK common_base)\nadd_library(made_by_hand)\n"},
      {arm_readme, arm_page()},
      {joint_header, header("prehend::arm", include("common/model/hand.hpp"))},
      {joint_source, joint("", "int least_torques(int x) {\n  return x.most_tested();\n}\n")},
      {joint_build, "prehend_library(LINK common_model)\n"},
      {"services/arm/files/store.hpp", header("prehend::arm")},
      {"services/arm/files/store.cpp",
       source("prehend::arm", include("services/arm/files/store.hpp"))},
      {"services/arm/files/CMakeLists.txt", "prehend_library()\n"},
      {"services/arm/devices/motor.hpp", header("prehend::arm")},
      {"services/arm/devices/motor.cpp",
       source("prehend::arm", include("services/arm/devices/motor.hpp"))},
      {"services/arm/devices/CMakeLists.txt", "prehend_library()\n"},
      {service_header, header("prehend::arm", include(joint_header))},
      {service_source, service("")},  // common/base comes through the core
      {"services/arm/service/main.cpp", include(service_header) + "int main() {\n  return 0;\n}\n"},
      {service_build, "prehend_library(LINK services_arm_core)\nprehend_program(prehend-arm)\n"},
      {"services/arm/tools/commands.hpp", header("prehend::arm")},
      {"services/arm/tools/turn_command.cpp",
       source("prehend::arm", tool_sources + include(joint_header),
              "void add_turn(tool::Program& program) {\n  program;\n}\n")},
      {tool_main, main_includes + main_code},
      {tool_build, "prehend_library(LINK services_arm_core)\nprehend_program(prehend-arm-tool)\n"},
      {"services/leg/README.md", "A leg.\n"},
      {"services/leg/core/knee.hpp", header("prehend::leg")},
      {"services/leg/core/knee.cpp",
       source("prehend::leg", include("services/leg/core/knee.hpp"), "class Wrist;\n")},
      {"services/leg/core/CMakeLists.txt", "prehend_library()\n"},
      {"tests/unit/help.hpp", "#pragma once\n"},
      {arm_test, arm_test_include + "std::set<int> figures{1};\n"},
  };
}

Agreed agreed_in_the_small_house() {
  return {small_edges,    small_cores,   small_functions, small_ends,
          small_commands, small_targets, small_pages,     small_retired};
}

std::vector<Break> breaks() {
  Breaks all = include_breaks();
  add(all, edge_breaks());
  add(all, layer_breaks());
  add(all, target_breaks());
  add(all, code_breaks());
  add(all, main_breaks());
  add(all, function_breaks());
  add(all, word_breaks());
  add(all, root_breaks());
  add(all, page_breaks());
  return all;
}

Tree::Tree(Texts texts) : texts_(std::move(texts)) {
  std::string name = (std::filesystem::temp_directory_path() / "prehend-house-XXXXXX").string();
  if (!::mkdtemp(name.data())) throw std::runtime_error("no temporary folder: " + name);
  root_ = name;
  change(texts_);
}

void Tree::change(const Texts& changes) {
  for (const auto& [path, text] : changes) {
    if (text.empty()) {
      std::filesystem::remove(root_ / path);
      continue;
    }
    std::filesystem::create_directories((root_ / path).parent_path());
    std::ofstream(root_ / path) << text;
  }
}

void Tree::undo(const Texts& changes) {
  for (const auto& [path, text] : changes) {
    if (const auto original = texts_.find(path); original != texts_.end()) {
      change({*original});
      continue;
    }
    std::error_code not_empty;
    for (auto left = root_ / path; left != root_; left = left.parent_path())
      if (!std::filesystem::remove(left, not_empty)) break;
  }
}

Tree::~Tree() {
  std::error_code ignored;
  std::filesystem::remove_all(root_, ignored);
}

}  // namespace prehend::architecture
