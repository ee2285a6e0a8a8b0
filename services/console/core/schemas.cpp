// JSON schemas of the documents. Viewers turn strings marked as base64 into bytes, and learn from a
// schema which fields there are.
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <utility>

#include "services/console/core/documents.hpp"

namespace prehend::console {
namespace {

using Fields = std::initializer_list<std::pair<const char*, Json>>;

Json object(Fields fields, const char* title = "") {
  Json made{{"type", "object"}, {"properties", Json::object()}};
  if (*title) made["title"] = title;
  for (const auto& [name, type] : fields) made["properties"][name] = type;
  return made;
}
Json list(Json items) {
  return {{"type", "array"}, {"items", std::move(items)}};
}
Json type(const char* name) {
  return {{"type", name}};
}
Json number() {
  return type("number");
}
Json integer() {
  return type("integer");
}
Json text() {
  return type("string");
}
Json flag() {
  return type("boolean");
}
Json time() {
  return object({{"sec", integer()}, {"nsec", integer()}}, "time");
}
Json duration() {
  return object({{"sec", integer()}, {"nsec", integer()}}, "duration");
}
Json vector() {
  return object({{"x", number()}, {"y", number()}, {"z", number()}});
}
Json quaternion() {
  return object({{"x", number()}, {"y", number()}, {"z", number()}, {"w", number()}});
}
Json pose() {
  return object({{"position", vector()}, {"orientation", quaternion()}});
}
Json colour() {
  return object({{"r", number()}, {"g", number()}, {"b", number()}, {"a", number()}});
}
Json point() {
  return object({{"x", number()}, {"y", number()}});
}

Json frame_transforms() {
  return object({{"transforms", list(object({{"timestamp", time()},
                                             {"parent_frame_id", text()},
                                             {"child_frame_id", text()},
                                             {"translation", vector()},
                                             {"rotation", quaternion()}}))}});
}

Json entities() {
  const Json arrow = object({{"pose", pose()},
                             {"shaft_length", number()},
                             {"shaft_diameter", number()},
                             {"head_length", number()},
                             {"head_diameter", number()},
                             {"color", colour()}});
  const Json solid = object({{"pose", pose()}, {"size", vector()}, {"color", colour()}});
  Json cylinder = solid;
  cylinder["properties"]["bottom_scale"] = number();
  cylinder["properties"]["top_scale"] = number();
  const Json line = object({{"type", integer()},
                            {"pose", pose()},
                            {"thickness", number()},
                            {"scale_invariant", flag()},
                            {"points", list(vector())},
                            {"color", colour()},
                            {"colors", list(colour())},
                            {"indices", list(integer())}});
  const Json triangle = object({{"pose", pose()},
                                {"points", list(vector())},
                                {"color", colour()},
                                {"colors", list(colour())},
                                {"indices", list(integer())}});
  const Json label = object({{"pose", pose()},
                             {"billboard", flag()},
                             {"font_size", number()},
                             {"scale_invariant", flag()},
                             {"color", colour()},
                             {"text", text()}});
  return list(object({{"timestamp", time()},
                      {"frame_id", text()},
                      {"id", text()},
                      {"lifetime", duration()},
                      {"frame_locked", flag()},
                      {"metadata", list(object({{"key", text()}, {"value", text()}}))},
                      {"arrows", list(arrow)},
                      {"cubes", list(solid)},
                      {"spheres", list(solid)},
                      {"cylinders", list(cylinder)},
                      {"lines", list(line)},
                      {"triangles", list(triangle)},
                      {"texts", list(label)},
                      {"models", list(type("object"))}}));
}

Json scene_update() {
  return object(
      {{"deletions", list(object({{"timestamp", time()}, {"type", integer()}, {"id", text()}}))},
       {"entities", entities()}});
}

Json compressed_image() {
  return object({{"timestamp", time()},
                 {"frame_id", text()},
                 {"data", Json{{"type", "string"}, {"contentEncoding", "base64"}}},
                 {"format", text()}});
}

Json image_annotations() {
  const Json circle = object({{"timestamp", time()},
                              {"position", point()},
                              {"diameter", number()},
                              {"thickness", number()},
                              {"fill_color", colour()},
                              {"outline_color", colour()}});
  const Json points = object({{"timestamp", time()},
                              {"type", integer()},
                              {"points", list(point())},
                              {"outline_color", colour()},
                              {"outline_colors", list(colour())},
                              {"fill_color", colour()},
                              {"thickness", number()}});
  const Json label = object({{"timestamp", time()},
                             {"position", point()},
                             {"text", text()},
                             {"font_size", number()},
                             {"text_color", colour()},
                             {"background_color", colour()}});
  return object({{"circles", list(circle)}, {"points", list(points)}, {"texts", list(label)}});
}

Json log() {
  return object({{"timestamp", time()},
                 {"level", integer()},
                 {"message", text()},
                 {"name", text()},
                 {"file", text()},
                 {"line", integer()}});
}

Json status() {
  const Json service = object({{"service", text()},
                               {"name", text()},
                               {"host", text()},
                               {"state", text()},
                               {"message", text()},
                               {"dropped", integer()}});
  const Json gate = object({{"hand", text()},
                            {"leader", text()},
                            {"stopped", flag()},
                            {"stopped_by", text()},
                            {"reason", text()},
                            {"deadman", flag()},
                            {"consent", flag()}});
  const Json missing = object({{"name", text()}, {"reason", text()}});
  return object({{"services", list(service)}, {"missing", list(missing)}, {"gates", list(gate)}});
}

Json latency() {
  return object({{"stages", list(object({{"service", text()},
                                         {"stage", text()},
                                         {"p50_ms", number()},
                                         {"p99_ms", number()},
                                         {"max_ms", number()},
                                         {"count", integer()}}))}});
}

Json report() {
  return object({{"hand", text()},
                 {"object", text()},
                 {"mode", text()},
                 {"grasp_type", text()},
                 {"contacts", list(type("object"))},
                 {"epsilon", number()},
                 {"volume", number()},
                 {"force_closure", flag()},
                 {"held", flag()},
                 {"reason", text()}});
}

Json reply() {
  return object({{"id", text()}, {"service", text()}, {"done", flag()}, {"message", text()}});
}

Json signals() {
  return object({{"timestamp", time()},
                 {"group", text()},
                 {"source", text()},
                 {"unit", text()},
                 {"names", list(text())},
                 {"values", list(number())}});
}

Json training() {
  return object({{"hand", text()},
                 {"phase", text()},
                 {"name", text()},
                 {"step", text()},
                 {"shown", integer()},
                 {"asked", integer()},
                 {"share", number()},
                 {"message", text()}});
}

}  // namespace

std::string json_schema(Feed feed) {
  Json made;
  switch (feed) {
    case Feed::tf:
      made = frame_transforms();
      break;
    case Feed::scene:
      made = scene_update();
      break;
    case Feed::image:
      made = compressed_image();
      break;
    case Feed::annotations:
      made = image_annotations();
      break;
    case Feed::report:
      made = report();
      break;
    case Feed::status:
      made = status();
      break;
    case Feed::latency:
      made = latency();
      break;
    case Feed::log:
      made = log();
      break;
    case Feed::reply:
      made = reply();
      break;
    case Feed::signals:
      made = signals();
      break;
    case Feed::training:
      made = training();
      break;
  }
  for (const FeedInfo& info : feeds)
    if (info.feed == feed) made["title"] = info.schema_name;
  return text_of(made);
}

}  // namespace prehend::console
