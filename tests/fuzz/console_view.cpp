// Damaged messages of every topic that is drawn: whatever decodes becomes documents that are JSON.
// The first byte of an input says which topic.
#include <array>
#include <nlohmann/json.hpp>

#include "services/console/core/lab_view.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"
#include "tests/fuzz/type_texts.hpp"
#include "tests/support/paths/paths.hpp"
#include "tests/unit/recording/random_message.hpp"

using namespace prehend;

namespace {

struct Case {
  std::string_view topic, type;
};
constexpr std::array cases{Case{"robot/state", "v1::HandState"},
                           Case{"object/state", "v1::ObjectState"},
                           Case{"scene/state", "v1::SceneState"},
                           Case{"hand/posture", "v1::HandPosture"},
                           Case{"camera/image", "v1::CameraImage"},
                           Case{"object/detection", "v1::ObjectDetection"},
                           Case{"grasp/report", "v1::GraspReport"},
                           Case{"service/status", "v1::ServiceStatus"},
                           Case{"robot/gate", "v1::GateState"},
                           Case{"operator/reply", "v1::OperatorReply"},
                           Case{"operator/command", "v1::OperatorCommand"},
                           Case{"robot/command", "v2::HandCommand"}};

void check(const console::Documents& documents) {
  for (const console::Document& document : documents) {
    const auto [opening, closing] = around(console::feeds[static_cast<std::size_t>(document.feed)]);
    fuzz::require(nlohmann::json::parse(opening + document.text + closing).is_object(),
                  "is no document");
  }
}

}  // namespace

int main(int argc, char** argv) {
  const recording::types::Library contract = fuzz::contract();
  const auto type_of = [&](const Case& one) {
    const auto* type = contract.find("prehend::" + std::string(one.type));
    fuzz::require(type, "no such type");
    return type;
  };
  const model::HandModel hand =
      model::HandModel::load(test::in_sources("common/models/hands/barrett")).value();
  fuzz::Fuzzer fuzzer;
  Random seed(1);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const auto* type = type_of(cases[i]);
    const auto bytes = testing::encode(*type, testing::random_value(*type, seed), false);
    fuzzer.seeds.push_back(static_cast<char>(i) + std::string(bytes.begin(), bytes.end()));
  }
  fuzzer.mutate = fuzz::mutate_bytes;
  fuzzer.target = [&](const std::string& bytes) {
    if (bytes.empty()) return false;
    const Case& one = cases[static_cast<std::uint8_t>(bytes[0]) % cases.size()];
    const auto value = recording::types::decode(
        *type_of(one), {reinterpret_cast<const std::uint8_t*>(bytes.data()) + 1, bytes.size() - 1});
    if (!value) return false;
    // Whatever it is called, it is this hand.
    console::LabView view(
        {.services = {"glove"}, .hand = [&](const std::string&) { return &hand; }});
    check(view.begin(1));
    check(view.hear(one.topic, *value, 2));
    check(view.hear(one.topic, *value, 3));
    check(view.lose(one.topic, *value, 4));
    return true;
  };
  return fuzz::run(fuzzer, argc, argv);
}
