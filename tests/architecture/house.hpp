#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace prehend::architecture {

/// Those that are ours.
inline constexpr std::array top_folders{"common", "deploy", "docs", "idl", "services", "tests"};

struct Include {
  int line = 0;  // from 1, as everywhere here
  std::string path;
  bool quoted = false;  // "path", not <path>
};

/// A file, line by line.
struct File {
  std::string path;                // from the root of the tree, as all paths here
  std::vector<std::string> lines;  // as they are
  std::vector<std::string> code;   // of C++: with blanks for comments and for what strings say
  std::vector<Include> includes;   // of C++
};

/// What is linked by prehend_library or prehend_program, by the names of targets.
struct Target {
  int line = 0;
  std::string name;  // of a program; of a library only if somebody named it, which is not done
  std::vector<std::string> link, private_link;
};

/// A CMakeLists.txt.
struct BuildFile {
  std::vector<Target> libraries, programs;
  std::vector<Target> raw;  // by add_library or add_executable
};

/// The tree as values: what lies in the folders that are ours.
struct House {
  std::set<std::string> paths;             // of all files and folders
  std::vector<File> sources;               // .hpp and .cpp
  std::vector<File> pages;                 // .md
  std::map<std::string, BuildFile> build;  // by folder
};

/// Reads the tree below `root`; what is no house is an empty one.
House read_house(const std::filesystem::path& root);

/// Neither a test nor how it is deployed.
bool is_of_the_product(const File& file);
/// It has main().
bool is_main(const File& file);

/// The folder that a file lies in: common/dds of common/dds/raw.hpp; empty at the root.
std::string folder_of(std::string_view path);

/// The first `count` names of a path: services/glove of services/glove/core/frame.hpp and 2.
std::string first_names(std::string_view path, int count);

/// C++ with blanks for comments and for what strings say; lines stay where they are.
std::string without_words(std::string_view text);

std::vector<std::string> lines_of(std::string_view text);
std::vector<std::string> words_of(std::string_view text);

}  // namespace prehend::architecture
