#include "tests/architecture/house.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <memory>
#include <sstream>

namespace prehend::architecture {
namespace {

// What recipes lay over a copy of this tree is no part of this one: tests/recipes/NAME/files.
constexpr std::string_view recipes = "tests/recipes/";

std::string text_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<Include> includes_of(const std::vector<std::string>& lines) {
  std::vector<Include> includes;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string& line = lines[i];
    if (!line.starts_with("#include ")) continue;
    const auto begin = line.find_first_of("\"<");
    if (begin == std::string::npos) continue;
    const auto end = line.find_first_of("\">", begin + 1);
    if (end == std::string::npos) continue;
    includes.push_back(
        {static_cast<int>(i + 1), line.substr(begin + 1, end - begin - 1), line[begin] == '"'});
  }
  return includes;
}

File file_of(std::string path, std::string_view text, bool cpp) {
  File file{std::move(path), lines_of(text), {}, {}};
  if (!cpp) return file;
  file.code = lines_of(without_words(text));
  file.includes = includes_of(file.lines);
  return file;
}

// What stands between the brackets of a call that begins at `begin`.
Target target_of(std::string_view text, std::size_t begin) {
  Target target;
  target.line = static_cast<int>(std::count(text.begin(), text.begin() + begin, '\n')) + 1;
  const auto open = text.find('(', begin);
  const auto words = words_of(text.substr(open + 1, text.find(')', open) - open - 1));
  std::vector<std::string>* list = nullptr;
  for (const std::string& word : words) {
    if (word == "LINK") {
      list = &target.link;
    } else if (word == "PRIVATE") {
      list = &target.private_link;
    } else if (word == "HOT" || word == "COMMANDS" || word == "VISION") {
      // How it is compiled and packed, which is no rule's business.
    } else if (list) {
      list->push_back(word);
    } else if (target.name.empty()) {
      target.name = word;
    }
  }
  return target;
}

BuildFile build_file_of(std::string text) {
  bool comment = false;
  for (char& c : text) {
    if (c == '#') comment = true;
    if (c == '\n') comment = false;
    if (comment) c = ' ';
  }
  const auto calls = [&text](std::string_view call) {
    std::vector<Target> targets;
    for (auto at = text.find(call); at != std::string::npos; at = text.find(call, at + 1))
      targets.push_back(target_of(text, at));
    return targets;
  };
  std::vector<Target> raw = calls("add_library(");
  for (Target& target : calls("add_executable(")) raw.push_back(std::move(target));
  return {calls("prehend_library("), calls("prehend_program("), std::move(raw)};
}

void take(House& house, const std::filesystem::path& root, const std::filesystem::path& file) {
  const std::string path = file.lexically_relative(root).generic_string();
  house.paths.insert(path);
  const std::string extension = file.extension().string();
  if (extension == ".hpp" || extension == ".cpp") {
    house.sources.push_back(file_of(path, text_of(file), true));
  } else if (extension == ".md") {
    house.pages.push_back(file_of(path, text_of(file), false));
  } else if (file.filename() == "CMakeLists.txt") {
    house.build[folder_of(path)] = build_file_of(text_of(file));
  }
}

void take_folder(House& house, const std::filesystem::path& root,
                 const std::filesystem::path& folder) {
  const std::string path = folder.lexically_relative(root).generic_string();
  if (path.starts_with(recipes) && path.ends_with("/files")) return;
  house.paths.insert(path);
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.is_directory()) {
      take_folder(house, root, entry.path());
    } else {
      take(house, root, entry.path());
    }
  }
}

// Names at the root that git keeps: who follows a tutorial leaves files of his own there. Empty:
// git knows nothing of this tree, so that all count.
std::set<std::string> kept_at_the_root(const std::filesystem::path& root) {
  std::set<std::string> names;
  const std::string command = "git -C '" + root.string() + "' ls-files 2>/dev/null";
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> git(::popen(command.c_str(), "r"),
                                                            ::pclose);
  std::array<char, 4096> line;
  while (git && std::fgets(line.data(), line.size(), git.get())) {
    const std::string_view path(line.data());
    names.emplace(path.substr(0, path.find_first_of("/\n")));
  }
  return names;
}

// The end of the comment or the string that begins at `at`; `at` itself where none does.
std::size_t end_of_words(std::string_view text, std::size_t at) {
  const auto after = [&](std::string_view end, std::size_t from) {
    const auto found = text.find(end, from);
    return found == std::string_view::npos ? text.size() : found + end.size();
  };
  const std::string_view rest = text.substr(at);
  if (rest.starts_with("//")) return std::min(text.find('\n', at), text.size());
  if (rest.starts_with("/*")) return after("*/", at + 2);
  const auto is_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
  if (rest.starts_with("R\"") && (at == 0 || !is_word(text[at - 1]))) {
    const auto open = text.find('(', at);
    if (open == std::string_view::npos) return text.size();
    std::string end(")");
    end.append(text.substr(at + 2, open - at - 2)).push_back('"');
    return after(end, open);
  }
  // ' also parts the digits of a number.
  if (rest[0] != '"' && (rest[0] != '\'' || (at > 0 && is_word(text[at - 1])))) return at;
  for (std::size_t i = at + 1; i < text.size(); ++i) {
    if (text[i] == '\\') {
      ++i;
    } else if (text[i] == '\n') {
      return i;  // was none
    } else if (text[i] == rest[0]) {
      return i + 1;
    }
  }
  return text.size();
}

}  // namespace

House read_house(const std::filesystem::path& root) {
  House house;
  std::error_code ignored;
  const std::set<std::string> kept = kept_at_the_root(root);
  for (const auto& entry : std::filesystem::directory_iterator(root, ignored)) {
    const std::string name = entry.path().filename().string();
    if (!kept.empty() && !kept.contains(name)) continue;
    if (entry.is_regular_file())
      take(house, root, entry.path());
    else if (name != "build")
      house.paths.insert(name);
  }
  for (const char* folder : top_folders)
    if (std::filesystem::is_directory(root / folder)) take_folder(house, root, root / folder);
  const auto by_path = [](const File& a, const File& b) { return a.path < b.path; };
  std::sort(house.sources.begin(), house.sources.end(), by_path);
  std::sort(house.pages.begin(), house.pages.end(), by_path);
  return house;
}

bool is_of_the_product(const File& file) {
  return file.path.starts_with("common/") || file.path.starts_with("services/");
}

bool is_main(const File& file) {
  return file.path.ends_with("/main.cpp");
}

std::string folder_of(std::string_view path) {
  const auto end = path.rfind('/');
  return std::string(end == std::string_view::npos ? "" : path.substr(0, end));
}

std::string first_names(std::string_view path, int count) {
  std::size_t end = 0;
  for (int i = 0; i < count; ++i) {
    end = path.find('/', i == 0 ? 0 : end + 1);
    if (end == std::string_view::npos) return std::string(path);
  }
  return std::string(path.substr(0, end));
}

std::string without_words(std::string_view text) {
  std::string code(text);
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = end_of_words(text, at);
    const bool is_string = end > at + 1 && text[at] != '/';
    for (std::size_t i = at; i < end; ++i)
      if (code[i] != '\n') code[i] = ' ';
    if (is_string) code[at] = code[end - 1] = '"';  // an argument stays one
    at = std::max(end, at + 1);
  }
  return code;
}

std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size());
    lines.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

std::vector<std::string> words_of(std::string_view text) {
  std::istringstream in{std::string(text)};
  return {std::istream_iterator<std::string>(in), {}};
}

}  // namespace prehend::architecture
