#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "services/glove/core/calibration/joint_calibrator.hpp"
#include "services/glove/devices/device.hpp"
#include "services/glove/files/user_file.hpp"
#include "services/glove/tools/asking.hpp"
#include "services/glove/tools/commands.hpp"

namespace prehend::glove {
namespace {

struct CalibrateArguments {
  service::LabArguments lab;
  std::string user, from, out;
  double limit = 300;
  bool json = false;
};

/// Such a glove's topic has angles, not what its sensors say: its driver is run here instead. What
/// an earlier calibration found out about the hand's bones is kept.
int calibrate_joints(const service::Config& config, const std::string& user, const std::string& out,
                     const CalibrateArguments& arguments) {
  UserCalibration result;
  if (std::filesystem::exists(out)) {
    const auto before = load_user(out);
    if (!before) return service::complain(before.error(), exit_broken);
    result = *before;
  } else {
    result.scale = config.number("glove.hand_scale");
    const model::HumanHand hand(result.scale);
    for (std::size_t f = 0; f < model::finger_count; ++f)
      result.bones[f] = hand.bones(static_cast<model::Finger>(f));
  }
  auto input = FrameInput::driven(config);
  if (!input) return service::complain(input.error(), exit_broken);
  JointCalibrator calibrator;
  const bool shown = ask(
      *input, calibrator, arguments.limit, [](ShownPose pose) { return instruction(pose); },
      [](const Shown& taken) {
        return fmt::format("{} taken, moved {:.1f} counts", to_string(taken.pose), taken.wobble);
      });
  if (!shown) return exit_no;
  const auto gains = calibrator.result();
  if (!gains) return service::complain(gains.error(), exit_no);
  result.user = user;
  result.gain = gains->gain;
  result.offset = gains->offset;
  if (const auto saved = save(out, result); !saved)
    return service::complain(saved.error(), exit_broken);
  log::info("gains and offsets of {} sensors; use them: --set glove.calibration={}",
            result.gain.size(), out);
  if (arguments.json)
    std::cout << nlohmann::ordered_json{{"output", out},
                                        {"user", user},
                                        {"gain_rad", result.gain},
                                        {"offset_rad", result.offset}}
                     .dump()
              << '\n';
  return exit_done;
}

int calibrate(const CalibrateArguments& arguments) {
  const auto config = arguments.lab.load();
  if (!config) return service::complain(config.error(), exit_wrong_use);
  const std::string user = arguments.user.empty() ? config->text("glove.user") : arguments.user;
  const bool plain =
      !user.empty() && user[0] != '.' && std::all_of(user.begin(), user.end(), [](unsigned char c) {
        return std::isalnum(c) || c == '_' || c == '-' || c == '.';
      });
  if (!plain)
    return service::complain({"a name of letters, digits, - _ . is needed", user, "give --user"},
                             exit_wrong_use);
  const std::string out = arguments.out.empty() ? "users/" + user + ".toml" : arguments.out;
  const auto kind = find_device(config->text("glove.device"));
  const bool measures_joints = kind && !kind->tracker.empty();
  if (arguments.from.empty() && measures_joints)
    return calibrate_joints(*config, user, out, arguments);

  auto input =
      arguments.from.empty() ? FrameInput::live(*config) : FrameInput::recorded(arguments.from);
  if (!input) return service::complain(input.error(), exit_broken);

  Calibrator calibrator;
  const bool shown = ask(
      *input, calibrator, arguments.limit, [](ShownPose pose) { return instruction(pose); },
      [](const Shown& taken) {
        return fmt::format("{} taken, moved {:.1f} mm", to_string(taken.pose), 1000 * taken.wobble);
      });
  if (!shown) return exit_no;
  const auto result = calibrator.result(user);
  if (!result) return service::complain(result.error(), exit_no);
  if (const auto saved = save(out, *result); !saved)
    return service::complain(saved.error(), exit_broken);
  log::info("hand scale {:.3f} ± {:.3f}; the poses fit within {:.1f} mm; {}", result->scale,
            result->scale_sd, 1000 * result->residual, out);
  log::info("use it: --set glove.calibration={}", out);
  if (arguments.json)
    std::cout << nlohmann::ordered_json{{"output", out},
                                        {"user", user},
                                        {"hand_scale", result->scale},
                                        {"hand_scale_sd", result->scale_sd},
                                        {"bones_m", result->bones},
                                        {"range_m", result->range},
                                        {"residual_m", result->residual}}
                     .dump()
              << '\n';
  return exit_done;
}

}  // namespace

void add_calibrate(tool::Program& program) {
  auto* command =
      program.app().add_subcommand("calibrate",
                                   "measure a user's hand: open hand, fist, pinch; the glove "
                                   "must be running (one that measures joints must "
                                   "not)");
  const auto a = std::make_shared<CalibrateArguments>();
  a->lab.add_to(*command);
  command->add_option("--user", a->user, "who wears the glove; default: glove.user");
  command->add_option("-o,--out", a->out, "file to write; default: users/USER.toml");
  command->add_option("--from", a->from, "a recording instead of a running glove (MCAP or CSV)");
  command->add_option("--limit", a->limit, "s after which it gives up")
      ->check(CLI::Range(1.0, 1e6))
      ->capture_default_str();
  command->add_flag("--json", a->json, "print the outcome as one JSON document");
  program.on(*command, [a] { return calibrate(*a); });
}

}  // namespace prehend::glove
