// What may include what: paths, folders, layers, and what a core may know.
#include <algorithm>
#include <array>
#include <functional>

#include "tests/architecture/rules.hpp"

namespace prehend::architecture {
namespace {

bool is_generated(std::string_view header) {
  return (header.starts_with("idl/") && header.ends_with(".h")) ||
         (header.starts_with("common/proto/") && header.ends_with(".pb.h"));
}

bool is_product(std::string_view path) {
  return path.starts_with("common/") || path.starts_with("services/");
}

// «core» of services/glove/core/calibration/still.hpp; empty beside the services.
std::string layer_of(std::string_view path) {
  if (!path.starts_with("services/")) return {};
  const std::string service = first_names(path, 2), layer = first_names(path, 3);
  return layer.size() > service.size() + 1 ? layer.substr(service.size() + 1) : "";
}

// The gate is one, too, though every robot's service shares it.
bool is_core(std::string_view path) {
  return layer_of(path) == "core" || path.starts_with("common/gate/") ||
         path.starts_with("common/arm/") || path.starts_with("common/carrying/") ||
         path.starts_with("common/planning/");
}

bool layer_may_include(std::string_view from, std::string_view to) {
  const auto is_device = [](std::string_view l) { return l == "devices" || l == "cameras"; };
  if (from == "core") return to == "core";
  if (from == "files") return to == "core" || to == "files";
  if (is_device(from)) return to == "core" || to == "files" || is_device(to);
  if (from == "service") return to != "tools";
  return from == "tools";
}

// Folders that lead back to themselves.
void report_cycles(const House& house, Violations& violations) {
  const auto edges = folder_edges(house);
  std::map<std::string, std::vector<std::string>> next;
  for (const auto& [edge, place] : edges) next[edge.first].push_back(edge.second);
  const auto reaches = [&next](const std::string& from, const std::string& to) {
    std::set<std::string> seen{from};
    std::vector<std::string> open{from};
    while (!open.empty()) {
      const std::string folder = open.back();
      open.pop_back();
      if (folder == to) return true;
      for (const std::string& other : next[folder])
        if (seen.insert(other).second) open.push_back(other);
    }
    return false;
  };
  for (const auto& [edge, place] : edges)
    if (reaches(edge.second, edge.first))
      violations.push_back(
          {place.file, place.line, edge.first + " and " + edge.second + " need each other"});
}

void report_common_edge(const File& file, const Include& include, std::span<const Edge> edges,
                        std::set<std::pair<std::string_view, std::string_view>>& used,
                        Violations& violations) {
  const std::string from = folder_of(file.path), to = folder_of(include.path);
  if (from == to || to.find("..") != std::string::npos) return;
  if (include.path.starts_with("services/") || include.path.starts_with("tests/")) {
    violations.push_back({file.path, include.line, "common includes " + include.path});
    return;
  }
  const auto edge = std::find_if(edges.begin(), edges.end(), [&](const Edge& candidate) {
    return candidate.from == from && candidate.to == to;
  });
  if (edge == edges.end()) {
    violations.push_back({file.path, include.line, from + " must not include " + to});
  } else {
    used.emplace(edge->from, edge->to);
  }
}

void report_service_edge(const File& file, const Include& include, Violations& violations) {
  if (include.path.starts_with("tests/")) {
    violations.push_back({file.path, include.line, "product code includes " + include.path});
  } else if (include.path.starts_with("services/") &&
             first_names(include.path, 2) != first_names(file.path, 2)) {
    violations.push_back(
        {file.path, include.line,
         first_names(file.path, 2) + " includes another service's " + include.path});
  }
}

struct Impure {
  std::string_view header;  // ends with / for all headers in there
  std::string_view why;
};

constexpr std::array impure_headers{
    Impure{"common/dds/", "DDS"},
    Impure{"common/service/", "DDS"},
    Impure{"common/convert/", "DDS"},
    Impure{"common/keys/", "DDS"},
    Impure{"idl/", "DDS"},
    Impure{"fastdds/", "DDS"},
    Impure{"fastrtps/", "DDS"},
    Impure{"common/base/clock.hpp", "clocks"},
    Impure{"ctime", "clocks"},
    Impure{"time.h", "clocks"},
    Impure{"sys/time.h", "clocks"},
    Impure{"thread", "threads"},
    Impure{"mutex", "threads"},
    Impure{"shared_mutex", "threads"},
    Impure{"atomic", "threads"},
    Impure{"condition_variable", "threads"},
    Impure{"future", "threads"},
    Impure{"common/base/workers.hpp", "threads"},
    Impure{"fstream", "files"},
    Impure{"filesystem", "files"},
    Impure{"cstdio", "files"},
    Impure{"stdio.h", "files"},
    Impure{"unistd.h", "files"},
    Impure{"fcntl.h", "files"},
    Impure{"common/proto/sealed_file.hpp", "files"},
    Impure{"iostream", "output"},
};

constexpr std::array impure_words{
    Impure{"system_clock", "clocks"},
    Impure{"steady_clock", "clocks"},
    Impure{"high_resolution_clock", "clocks"},
};

std::string_view why_impure(std::string_view header) {
  for (const Impure& impure : impure_headers)
    if (header == impure.header ||
        (impure.header.ends_with("/") && header.starts_with(impure.header)))
      return impure.why;
  return {};
}

}  // namespace

std::map<std::pair<std::string, std::string>, Violation> folder_edges(const House& house) {
  std::map<std::pair<std::string, std::string>, Violation> edges;
  for (const File& file : house.sources)
    for (const Include& include : file.includes) {
      if (!include.quoted || !is_product(file.path)) continue;
      const std::string from = folder_of(file.path), to = folder_of(include.path);
      if (from != to) edges.try_emplace({from, to}, Violation{file.path, include.line, ""});
    }
  return edges;
}

Violations broken_includes(const House& house, const Agreed&) {
  Violations violations;
  std::set<std::string_view> included;
  for (const File& file : house.sources)
    for (const Include& include : file.includes) {
      const auto stops = [&](const std::string& what) {
        violations.push_back({file.path, include.line, what});
      };
      if (include.quoted) included.insert(include.path);
      const bool is_ours = is_product(include.path) || include.path.starts_with("idl/") ||
                           include.path.starts_with("prehend/");
      if (include.path.find("../") != std::string::npos) {
        stops(include.path + " is not named from the root");
      } else if (!include.quoted && is_ours) {
        stops("our own header in <>: " + include.path);
      } else if (include.quoted && !house.paths.contains(include.path) &&
                 !is_generated(include.path)) {
        stops("there is no " + include.path);
      }
    }
  for (const File& file : house.sources) {
    if (!file.path.ends_with(".hpp")) continue;
    if (std::find(file.lines.begin(), file.lines.end(), "#pragma once") == file.lines.end())
      violations.push_back({file.path, 1, "has no #pragma once"});
    if (!included.contains(file.path)) violations.push_back({file.path, 1, "nobody includes it"});
  }
  return violations;
}

Violations broken_edges(const House& house, const Agreed& agreed) {
  Violations violations;
  std::set<std::pair<std::string_view, std::string_view>> used;
  for (const File& file : house.sources)
    for (const Include& include : file.includes) {
      if (!include.quoted) continue;
      if (file.path.starts_with("common/")) {
        report_common_edge(file, include, agreed.edges, used, violations);
      } else if (file.path.starts_with("services/")) {
        report_service_edge(file, include, violations);
      }
    }
  for (const Edge& edge : agreed.edges)
    if (!used.contains({edge.from, edge.to}))
      violations.push_back({std::string(agreed_file), 1,
                            std::string(edge.from) + " no longer includes " + std::string(edge.to) +
                                ": take the edge out"});
  report_cycles(house, violations);
  return violations;
}

Violations broken_layers(const House& house, const Agreed&) {
  Violations violations;
  for (const File& file : house.sources) {
    if (!file.path.starts_with("services/")) continue;
    for (const Include& include : file.includes) {
      // Other services are the business of the edges.
      if (!include.quoted || first_names(include.path, 2) != first_names(file.path, 2)) continue;
      const std::string from = layer_of(file.path), to = layer_of(include.path);
      if (!layer_may_include(from, to))
        violations.push_back({file.path, include.line, from + " includes " + include.path});
    }
  }
  return violations;
}

Violations impure_cores(const House& house, const Agreed& agreed) {
  Violations violations;
  Exceptions exceptions(agreed.impure_cores);
  for (const File& file : house.sources) {
    if (!is_core(file.path)) continue;
    for (const Include& include : file.includes) {
      const std::string_view why = why_impure(include.path);
      if (!why.empty() && !exceptions.allow(file.path, include.path))
        violations.push_back(
            {file.path, include.line, "a core includes " + include.path + ": " + std::string(why)});
    }
    for (std::size_t i = 0; i < file.code.size(); ++i)
      for (const Impure& word : impure_words)
        if (file.code[i].find(word.header) != std::string::npos &&
            !exceptions.allow(file.path, word.header))
          violations.push_back({file.path, static_cast<int>(i + 1),
                                "a core asks for the time: " + std::string(word.header)});
  }
  exceptions.report_unused(violations);
  return violations;
}

}  // namespace prehend::architecture
