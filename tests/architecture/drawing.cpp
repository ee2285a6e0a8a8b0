#include "tests/architecture/drawing.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <set>

namespace prehend::architecture {
namespace {

using Graph = std::map<std::string, std::set<std::string>>;

// Folders of common by their two first names; layers of services by their three.
std::string node_of(const std::string& path) {
  if (path.starts_with("idl/")) return "idl";
  if (path.starts_with("common/")) return first_names(path, 2);
  if (path.starts_with("services/")) return first_names(path, 3);
  return {};
}

Graph graph_of(const House& house) {
  Graph graph;
  for (const File& file : house.sources) {
    const std::string from = node_of(file.path);
    if (from.empty()) continue;
    graph[from];
    for (const Include& include : file.includes)
      if (include.quoted && node_of(include.path) != from)
        graph[from].insert(node_of(include.path));
  }
  return graph;
}

std::set<std::string> reached_from(const Graph& graph, const std::string& node) {
  std::set<std::string> reached;
  std::vector<std::string> open{node};
  while (!open.empty()) {
    const auto next = graph.find(open.back());
    open.pop_back();
    if (next == graph.end()) continue;
    for (const std::string& to : next->second)
      if (reached.insert(to).second) open.push_back(to);
  }
  return reached;
}

// Of what a node includes, what none of the others leads to.
std::set<std::string> direct(const Graph& graph, const std::string& node) {
  std::set<std::string> left = graph.at(node);
  for (const std::string& to : graph.at(node))
    for (const std::string& further : reached_from(graph, to)) left.erase(further);
  return left;
}

std::string last_name(const std::string& path) {
  return path.substr(path.rfind('/') + 1);
}

std::string id_of(std::string path) {
  std::replace(path.begin(), path.end(), '/', '_');
  return path;
}

std::string common_drawing(const Graph& graph) {
  std::string text = "```mermaid\nflowchart TD\n  idl([idl])\n";
  for (const auto& [node, includes] : graph)
    if (node.starts_with("common/")) text += "  " + id_of(node) + "[" + last_name(node) + "]\n";
  for (const auto& [node, includes] : graph)
    if (node.starts_with("common/"))
      for (const std::string& to : direct(graph, node))
        text += "  " + id_of(node) + " --> " + id_of(to) + "\n";
  return text + "```\n";
}

// What a layer takes from common (and idl), without what its service's other layers bring it.
std::string label_of(const Graph& graph, const std::string& layer) {
  std::string label = last_name(layer);
  for (const std::string& to : direct(graph, layer))
    if (!to.starts_with("services/"))
      label += (label == last_name(layer) ? "<br/>" : " ") + last_name(to);
  return label;
}

std::string services_drawing(const Graph& graph) {
  std::map<std::string, std::vector<std::string>> layers;
  for (const auto& [node, includes] : graph)
    if (node.starts_with("services/")) layers[first_names(node, 2)].push_back(node);
  std::string text = "```mermaid\nflowchart TD\n";
  for (const auto& [service, nodes] : layers) {
    text += "  subgraph " + last_name(service) + "\n";
    for (const std::string& node : nodes)
      text += "    " + id_of(node) + "[\"" + label_of(graph, node) + "\"]\n";
    for (const std::string& node : nodes)
      for (const std::string& to : direct(graph, node))
        if (to.starts_with("services/")) text += "    " + id_of(node) + " --> " + id_of(to) + "\n";
    text += "  end\n";
  }
  return text + "```\n";
}

}  // namespace

std::string drawing(const House& house) {
  const Graph graph = graph_of(house);
  return common_drawing(graph) +
         "\nThe services. In a box: a layer, and what it takes from common beside what the boxes\n"
         "below it bring.\n\n" +
         services_drawing(graph);
}

std::string with_drawing(const std::string& page, const std::string& drawing) {
  const auto begin = page.find(drawing_begins), end = page.find(drawing_ends);
  if (begin == std::string::npos || end == std::string::npos || end < begin) return page;
  return page.substr(0, begin) + drawing_begins + "\n" + drawing + page.substr(end);
}

}  // namespace prehend::architecture
