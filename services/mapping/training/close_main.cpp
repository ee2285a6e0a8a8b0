// prehend-close: closes a hand on the lab's objects for the build, which keeps what came of it for
// as long as this program and its data stay the same. Everybody else asks prehend train.
#include <CLI/CLI.hpp>
#include <prehend/base/log.hpp>
#include <prehend/base/paths.hpp>

#include "closures.hpp"

int main(int argc, char** argv) {
  using namespace prehend;
  log::set_name("close");
  std::string hand_name, out;
  CLI::App app{"Closes a robot hand on all objects"};
  app.add_option("--hand", hand_name, "kind of robot hand")->required();
  app.add_option("--out", out, "grasps to write")->required();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  const auto refuse = [](const Error& error) {
    log::error("{}", error.message());
    return 3;
  };
  const auto share = share_directory();
  const auto hand = model::HandModel::load(share / "models" / "hands" / hand_name);
  if (!hand) return refuse(hand.error());
  const auto scheme = mapping::Scheme::load(mapping::scheme_path(hand_name), *hand);
  if (!scheme) return refuse(scheme.error());
  const auto grasps =
      mapping::close_and_save(*hand, *scheme, share / "models" / "objects" / "catalogue.toml", out);
  if (!grasps) return refuse(grasps.error());
  log::info("{} grasps, {}", grasps->size(), out);
  return 0;
}
