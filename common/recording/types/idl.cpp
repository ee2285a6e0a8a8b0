#include "common/recording/types/idl.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <fstream>
#include <iterator>
#include <optional>
#include <set>

#include "common/base/paths.hpp"

namespace prehend::recording::types {
namespace {

struct Token {
  std::string text;  // empty: the end
  int line = 1;
  bool literal = false;  // a string
};

class Tokens {
 public:
  explicit Tokens(std::string_view text) : rest_(text) { advance(); }

  const Token& peek() const { return token_; }
  Token take() {
    Token token = token_;
    advance();
    return token;
  }
  bool take_if(std::string_view text) {
    if (token_.text != text || token_.literal) return false;
    advance();
    return true;
  }

 private:
  static bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

  void skip_blank() {
    while (!rest_.empty()) {
      if (rest_.starts_with("//")) {
        rest_.remove_prefix(std::min(rest_.find('\n'), rest_.size()));
      } else if (rest_.starts_with("/*")) {
        const std::size_t end = std::min(rest_.find("*/", 2), rest_.size() - 2) + 2;
        line_ += static_cast<int>(std::ranges::count(rest_.substr(0, end), '\n'));
        rest_.remove_prefix(end);
      } else if (std::isspace(static_cast<unsigned char>(rest_.front()))) {
        line_ += rest_.front() == '\n';
        rest_.remove_prefix(1);
      } else {
        return;
      }
    }
  }

  void advance() {
    skip_blank();
    std::size_t length = 0;
    bool literal = false;
    if (!rest_.empty() && rest_.front() == '"') {
      literal = true;
      length = std::min(rest_.find('"', 1), rest_.size() - 1) + 1;
    } else if (rest_.starts_with("::")) {
      length = 2;
    } else if (!rest_.empty()) {
      while (length < rest_.size() && is_word(rest_[length])) ++length;
      length = std::max<std::size_t>(length, 1);
    }
    token_ = {std::string(rest_.substr(0, length)), line_, literal};
    rest_.remove_prefix(length);
  }

  std::string_view rest_;
  int line_ = 1;
  Token token_;
};

constexpr int max_modules = 32;  // inside each other: a text must not decide how deep we recurse

class Parser {
 public:
  Parser(std::string_view text, std::string origin, std::shared_ptr<const std::string> source,
         Library& library)
      : tokens_(text), origin_(std::move(origin)), source_(std::move(source)), library_(library) {}

  Expected<void> file() {
    while (!tokens_.peek().text.empty())
      if (auto done = definition(); !done) return done;
    return {};
  }

 private:
  struct Annotations {
    bool key = false;
    std::optional<std::uint32_t> value;
  };

  tl::unexpected<Error> error(const std::string& what) const {
    return fail(what, origin_ + " line " + std::to_string(tokens_.peek().line));
  }
  Expected<void> expect(std::string_view text) {
    if (tokens_.take_if(text)) return {};
    return error("«" + std::string(text) + "» is missing before «" + tokens_.peek().text + "»");
  }
  Expected<std::string> name() {
    const Token token = tokens_.take();
    if (token.literal || token.text.empty() ||
        (!std::isalpha(static_cast<unsigned char>(token.text[0])) && token.text[0] != '_'))
      return error("a name is missing");
    return token.text;
  }
  std::string scoped(const std::string& name) const { return scope_ + name; }

  std::optional<std::uint32_t> whole_number(const Token& token) const {
    if (const auto constant = constants_.find(token.text); constant != constants_.end())
      return constant->second;
    std::uint32_t value = 0;
    const char* end = token.text.data() + token.text.size();
    const auto [stop, problem] = std::from_chars(token.text.data(), end, value);
    if (problem != std::errc() || stop != end) return std::nullopt;
    return value;
  }
  Expected<std::uint32_t> number() {
    const Token token = tokens_.take();
    if (const auto value = whole_number(token)) return *value;
    return error("«" + token.text + "» is no whole number of 32 bits");
  }

  Expected<Annotations> annotations() {
    Annotations found;
    while (tokens_.take_if("@")) {
      const auto which = name();
      if (!which) return tl::unexpected(which.error());
      if (*which == "key") found.key = true;
      if (!tokens_.take_if("(")) continue;
      if (*which == "value") {
        const auto value = number();
        if (!value) return tl::unexpected(value.error());
        found.value = *value;
      }
      while (!tokens_.take_if(")")) {
        if (tokens_.peek().text.empty()) return error("«)» is missing");
        tokens_.take();
      }
    }
    return found;
  }

  Expected<void> definition() {
    if (const auto found = annotations(); !found) return tl::unexpected(found.error());
    Expected<void> done;
    if (tokens_.take_if("module"))
      done = module();
    else if (tokens_.take_if("struct"))
      done = structure();
    else if (tokens_.take_if("enum"))
      done = enumeration();
    else if (tokens_.take_if("const"))
      done = constant();
    else if (tokens_.take_if("typedef"))
      done = definition_of_type();
    else
      return error("«" + tokens_.peek().text + "» is not understood here");
    if (!done) return done;
    return expect(";");
  }

  Expected<void> module() {
    const auto called = name();
    if (!called) return tl::unexpected(called.error());
    if (auto done = expect("{"); !done) return done;
    if (++depth_ > max_modules) return error("too many modules inside each other");
    const std::string outside = scope_;
    scope_ += *called + "::";
    while (!tokens_.take_if("}")) {
      if (tokens_.peek().text.empty()) return error("«}» is missing");
      if (auto done = definition(); !done) return done;
    }
    scope_ = outside;
    --depth_;
    return {};
  }

  Expected<void> structure() {
    const auto called = name();
    if (!called) return tl::unexpected(called.error());
    if (auto done = expect("{"); !done) return done;
    Structure result{.name = scoped(*called), .source = source_};
    while (!tokens_.take_if("}")) {
      const auto notes = annotations();
      if (!notes) return tl::unexpected(notes.error());
      const auto base = type();
      if (!base) return tl::unexpected(base.error());
      do {
        const auto field = declarator(*base);
        if (!field) return tl::unexpected(field.error());
        if (result.find(field->name)) return error("field " + field->name + " is there twice");
        result.fields.push_back({field->name, field->type, notes->key});
      } while (tokens_.take_if(","));
      if (auto done = expect(";"); !done) return done;
    }
    if (const auto added = library_.add(std::move(result)); !added)
      return error(added.error().what);
    return {};
  }

  Expected<void> enumeration() {
    const auto called = name();
    if (!called) return tl::unexpected(called.error());
    if (auto done = expect("{"); !done) return done;
    Enumeration result{scoped(*called), {}};
    std::uint32_t next = 0;
    do {
      const auto notes = annotations();
      if (!notes) return tl::unexpected(notes.error());
      const auto enumerator = name();
      if (!enumerator) return tl::unexpected(enumerator.error());
      const std::uint32_t value = notes->value.value_or(next);
      result.enumerators.emplace_back(*enumerator, value);
      next = value + 1;
    } while (tokens_.take_if(","));
    if (auto done = expect("}"); !done) return done;
    if (const auto added = library_.add(std::move(result)); !added)
      return error(added.error().what);
    return {};
  }

  Expected<void> constant() {
    if (const auto kind = type(); !kind) return tl::unexpected(kind.error());
    const auto called = name();
    if (!called) return tl::unexpected(called.error());
    if (auto done = expect("="); !done) return done;
    // A text, a fraction or a negative number bounds nothing.
    if (const auto value = whole_number(tokens_.peek())) constants_[*called] = *value;
    while (tokens_.peek().text != ";" && !tokens_.peek().text.empty()) tokens_.take();
    return {};
  }

  Expected<void> definition_of_type() {
    const auto base = type();
    if (!base) return tl::unexpected(base.error());
    const auto field = declarator(*base);
    if (!field) return tl::unexpected(field.error());
    aliases_[scoped(field->name)] = field->type;
    return {};
  }

  /// A name and, for an array, its dimensions.
  Expected<Field> declarator(Type base) {
    const auto called = name();
    if (!called) return tl::unexpected(called.error());
    std::uint64_t count = 1;
    bool array = false;
    while (tokens_.take_if("[")) {
      const auto size = number();
      if (!size) return tl::unexpected(size.error());
      array = true;
      count *= *size;
      if (count == 0 || count > UINT32_MAX) return error("an array of an impossible size");
      if (auto done = expect("]"); !done) return tl::unexpected(done.error());
    }
    if (array && base.many != Type::Many::one) return error("an array of collections");
    if (array) {
      base.many = Type::Many::array;
      base.count = static_cast<std::uint32_t>(count);
    }
    return Field{*called, base};
  }

  Expected<Type> type() {
    if (tokens_.take_if("sequence")) return sequence();
    if (tokens_.take_if("string")) {
      Type result{.kind = Kind::string};
      if (!tokens_.take_if("<")) return result;
      const auto bound = number();
      if (!bound) return tl::unexpected(bound.error());
      result.string_bound = *bound;
      if (auto done = expect(">"); !done) return tl::unexpected(done.error());
      return result;
    }
    if (const auto kind = primitive()) return Type{.kind = *kind};
    return named();
  }

  Expected<Type> sequence() {
    if (auto done = expect("<"); !done) return tl::unexpected(done.error());
    if (tokens_.peek().text == "sequence") return error("a sequence of collections");
    auto element = type();
    if (!element) return element;
    if (element->many != Type::Many::one) return error("a sequence of collections");
    element->many = Type::Many::sequence;
    if (tokens_.take_if(",")) {
      const auto bound = number();
      if (!bound) return tl::unexpected(bound.error());
      element->count = *bound;
    }
    if (auto done = expect(">"); !done) return tl::unexpected(done.error());
    return element;
  }

  std::optional<Kind> primitive() {
    static const std::map<std::string_view, Kind> words{
        {"boolean", Kind::boolean}, {"octet", Kind::uint8},   {"char", Kind::character},
        {"short", Kind::int16},     {"float", Kind::float32}, {"double", Kind::float64},
        {"int8", Kind::int8},       {"uint8", Kind::uint8},   {"int16", Kind::int16},
        {"uint16", Kind::uint16},   {"int32", Kind::int32},   {"uint32", Kind::uint32},
        {"int64", Kind::int64},     {"uint64", Kind::uint64}};
    if (tokens_.take_if("unsigned")) {
      if (tokens_.take_if("short")) return Kind::uint16;
      if (!tokens_.take_if("long")) return std::nullopt;
      return tokens_.take_if("long") ? Kind::uint64 : Kind::uint32;
    }
    if (tokens_.take_if("long")) return tokens_.take_if("long") ? Kind::int64 : Kind::int32;
    const auto word = words.find(tokens_.peek().text);
    if (word == words.end()) return std::nullopt;
    tokens_.take();
    return word->second;
  }

  /// A type by its name, looked for from the innermost scope outwards.
  Expected<Type> named() {
    const bool absolute = tokens_.take_if("::");
    auto wanted = name();
    if (!wanted) return tl::unexpected(wanted.error());
    while (tokens_.take_if("::")) {
      const auto part = name();
      if (!part) return tl::unexpected(part.error());
      *wanted += "::" + *part;
    }
    std::string scope = absolute ? "" : scope_;
    while (true) {
      const std::string full = scope + *wanted;
      if (const Structure* structure = library_.find(full))
        return Type{.kind = Kind::structure, .structure = structure};
      if (const Enumeration* enumeration = library_.find_enumeration(full))
        return Type{.kind = Kind::enumeration, .enumeration = enumeration};
      if (const auto alias = aliases_.find(full); alias != aliases_.end()) return alias->second;
      if (scope.empty()) return error("the type " + *wanted + " is not known");
      const std::size_t inner = scope.rfind("::", scope.size() - 3);
      scope = inner == std::string::npos ? "" : scope.substr(0, inner + 2);
    }
  }

  Tokens tokens_;
  std::string origin_;
  std::shared_ptr<const std::string> source_;
  Library& library_;
  std::string scope_;
  int depth_ = 0;
  std::map<std::string, std::uint32_t> constants_;
  std::map<std::string, Type> aliases_;
};

/// A file without its preprocessor lines, and which files it includes.
struct Source {
  std::string own;
  std::vector<std::filesystem::path> includes;
};

Expected<Source> read_source(const std::filesystem::path& path) {
  std::ifstream in(path);
  if (!in) return fail("cannot be read", path.string());
  Source source;
  std::string line;
  while (std::getline(in, line)) {
    if (line.starts_with("#include")) {
      const std::size_t open = line.find('"'), close = line.rfind('"');
      if (open == close) return fail("an include without a file name", path.string());
      source.includes.push_back(path.parent_path() / line.substr(open + 1, close - open - 1));
    }
    source.own += line.starts_with("#") ? "\n" : line + "\n";  // line numbers stay
  }
  return source;
}

/// Loads files after those they include, each once.
class Folder {
 public:
  Expected<void> load(const std::filesystem::path& path) {
    if (!loaded_.insert(path).second) return {};
    const auto source = read_source(path);
    if (!source) return tl::unexpected(source.error());
    for (const std::filesystem::path& included : source->includes)
      if (auto done = load(included); !done) return done;
    std::set<std::filesystem::path> seen;
    auto whole = std::make_shared<std::string>(flatten(path, seen));
    return Parser(source->own, path.string(), std::move(whole), library).file();
  }

  Library library;

 private:
  /// The file with those it includes in front.
  std::string flatten(const std::filesystem::path& path, std::set<std::filesystem::path>& seen) {
    if (!seen.insert(path).second) return {};
    const auto source = read_source(path);
    std::string text;
    if (!source) return text;
    for (const std::filesystem::path& included : source->includes) text += flatten(included, seen);
    return text +
           source->own.substr(std::min(source->own.find_first_not_of('\n'), source->own.size()));
  }

  std::set<std::filesystem::path> loaded_;
};

}  // namespace

Expected<void> parse_idl(std::string_view text, const std::string& origin, Library& library) {
  return Parser(text, origin, std::make_shared<std::string>(text), library).file();
}

Expected<Library> load_idl(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code problem;
  for (const auto& entry : std::filesystem::directory_iterator(folder, problem))
    if (entry.path().extension() == ".idl") files.push_back(entry.path());
  if (problem) return fail(problem.message(), folder.string(), "is PREHEND_SHARE right?");
  std::ranges::sort(files);
  Folder contents;
  for (const std::filesystem::path& file : files)
    if (auto done = contents.load(file); !done) return tl::unexpected(done.error());
  return std::move(contents.library);
}

Expected<Library> load_contract() {
  return load_idl(share_directory() / "idl");
}

}  // namespace prehend::recording::types
