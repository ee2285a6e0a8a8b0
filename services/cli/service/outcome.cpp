#include "services/cli/service/outcome.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "common/base/printable.hpp"
#include "common/convert/names.hpp"

namespace prehend::cli {
namespace {

using Json = nlohmann::ordered_json;

std::string in_words(const model::Shape& shape) {
  const Eigen::Vector3d mm = shape.size * 1000;
  switch (shape.kind) {
    case model::ShapeKind::cylinder:
      return fmt::format("cylinder, {:.0f} mm wide, {:.0f} mm high", 2 * mm.x(), mm.z());
    case model::ShapeKind::box:
      return fmt::format("box, {:.0f} x {:.0f} x {:.0f} mm", mm.x(), mm.y(), mm.z());
    case model::ShapeKind::cone:
      return fmt::format("cone, {:.0f} mm wide below and {:.0f} mm above, {:.0f} mm high",
                         2 * mm.x(), 2 * mm.y(), mm.z());
    case model::ShapeKind::sphere:
      return fmt::format("sphere, {:.0f} mm wide", 2 * mm.x());
    default:
      return "of unknown shape";
  }
}

std::string with_spaces(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c == '_') c = ' ';
  return result;
}

}  // namespace

namespace {

std::string_view name_of(v1::MappingMode mode) {
  return convert::mode_names.name(mode, "hold");
}

std::string_view name_of(v1::GraspType type) {
  return convert::grasp_names.name(type, "none");
}

}  // namespace

std::string to_json(const Outcome& outcome) {
  Json object;
  if (outcome.object) {
    const Outcome::Object& seen = *outcome.object;
    object = {{"name", seen.name},
              {"shape", model::to_string(seen.shape.kind)},
              {"size_m", {seen.shape.size.x(), seen.shape.size.y(), seen.shape.size.z()}},
              {"position_error_m", nullptr}};
    if (seen.position_error) object["position_error_m"] = *seen.position_error;
  }
  const Outcome::Grasp& grasp = outcome.grasp;
  Json latency = {{"p50", nullptr}, {"p99", nullptr}};
  if (outcome.latency) latency = {{"p50", outcome.latency->p50}, {"p99", outcome.latency->p99}};
  Json target;
  if (!outcome.target.empty()) target = outcome.target;
  Json document = {
      {"object", object},
      {"mapping",
       {{"mode", name_of(outcome.mode)},
        {"weight", outcome.weight},
        {"hand", outcome.hand},
        {"grasp_type", name_of(outcome.grasp_type)}}},
      {"grasp",
       {{"contacts", grasp.contacts},
        {"epsilon", grasp.epsilon},
        {"volume", grasp.volume},
        {"force_closure", grasp.force_closure},
        {"held", grasp.held},
        {"reason", grasp.reason}}},
      {"latency_ms", latency},
      {"glove",
       {{"device", outcome.device}, {"frames", outcome.frames}, {"rejected", outcome.rejected}}},
      {"target", target},
      {"duration_s", outcome.seconds},
  };
  if (outcome.arm)
    document["arm"] = {{"name", outcome.arm->name},
                       {"worst_joint_speed", outcome.arm->worst_joint_speed},
                       {"out_of_reach", outcome.arm->out_of_reach}};
  // Names come from outside: bytes that are no UTF-8 are replaced.
  return document.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string to_table(const Outcome& outcome) {
  std::string text;
  const auto row = [&text](std::string_view name, const std::string& value) {
    text += fmt::format("{:<12}{}\n", name, printable(value));
  };
  if (outcome.object) {
    const Outcome::Object& seen = *outcome.object;
    row("object", seen.name);
    row("shape", in_words(seen.shape));
    row("position", seen.position_error
                        ? fmt::format("{:.1f} mm from the truth", *seen.position_error * 1000)
                        : std::string("no truth to compare with"));
  } else {
    row("object", "none recognised");
  }
  if (!outcome.target.empty()) row("target", outcome.target);
  row("mapping", fmt::format("{}, weight {:.2f}, {}", name_of(outcome.mode), outcome.weight,
                             outcome.hand.empty() ? "no hand" : outcome.hand));
  row("grasp", with_spaces(name_of(outcome.grasp_type)));
  const Outcome::Grasp& grasp = outcome.grasp;
  if (outcome.judged)
    row("quality",
        fmt::format("{} contacts, ε {:.4f}, volume {:.4g}, {}", grasp.contacts, grasp.epsilon,
                    grasp.volume, grasp.force_closure ? "force closure" : "no force closure"));
  row("result", grasp.held ? std::string("held")
                           : fmt::format("{}: {}", outcome.judged ? "dropped" : "no grasp",
                                         grasp.reason.empty() ? "no reason given" : grasp.reason));
  if (outcome.arm)
    row("arm",
        fmt::format("{}, joints at most at {:.0f} % of their speed, hindered {:.0f} % of the time",
                    outcome.arm->name, 100 * outcome.arm->worst_joint_speed,
                    100 * outcome.arm->out_of_reach));
  row("latency", outcome.latency ? fmt::format("glove to simulation p50 {:.2f} ms, p99 {:.2f} ms",
                                               outcome.latency->p50, outcome.latency->p99)
                                 : std::string("not measured"));
  row("glove",
      fmt::format("{}, {} frames, {} rejected", outcome.device.empty() ? "silent" : outcome.device,
                  outcome.frames, outcome.rejected));
  return text;
}

}  // namespace prehend::cli
