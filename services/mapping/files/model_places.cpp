#include "services/mapping/files/model_places.hpp"

#include <fcntl.h>
#include <unistd.h>

#include "common/base/file_text.hpp"
#include "common/base/paths.hpp"
#include "common/model/hand_model.hpp"
#include "common/proto/sealed_file.hpp"
#include "services/mapping/files/mapping_model_file.hpp"

namespace prehend::mapping {
namespace {

namespace fs = std::filesystem;

/// Changes when the same hand comes to another model.
constexpr std::string_view maker = "2";

std::string digest_of(const fs::path& folder) {
  std::string all(maker);
  const fs::path files = model::hand_files(folder);
  for (const char* part : {"hand.urdf", "hand.toml", "scheme.toml"})
    all += proto::digest(read_file(files / part).value_or(""));
  return proto::digest(all);
}

bool is_writable(const fs::path& folder) {
  return ::faccessat(AT_FDCWD, folder.c_str(), W_OK, AT_EACCESS) == 0;
}

/// Where a hand keeps its files that may not be beside it.
fs::path kept_folder(const std::string& name, const std::string& made_for) {
  return state_directory() / "hands" / (name + "-" + made_for.substr(0, 12));
}

}  // namespace

ModelPlaces model_places(const std::string& hand) {
  const auto share = share_directory();
  const auto folder = model::hand_directory(hand);
  std::error_code none;
  // By whatever links they are reached.
  const auto whole = fs::weakly_canonical(folder / "hand.toml", none).parent_path();
  const auto ours = fs::weakly_canonical(share / "models" / "hands", none);
  const std::string name = whole.filename();
  const bool no_state = state_directory().empty();
  if (whole.parent_path() == ours) {
    const fs::path trained = share / "trained", scheme = share / "schemes" / (name + ".toml");
    const fs::path model = trained / (name + ".mapping");
    if (fs::exists(model, none) || is_writable(trained) || no_state)
      return {trained / (name + ".grasps"), model, scheme, ""};
    const std::string made_for = digest_of(folder);
    const fs::path kept = kept_folder(name, made_for);
    return {kept / "hand.grasps", kept / "hand.mapping", scheme, made_for};
  }
  const std::string made_for = digest_of(folder);
  const bool beside =
      is_writable(folder) || no_state || was_made_for(folder / "hand.mapping", made_for);
  const fs::path kept = beside ? folder : kept_folder(name, made_for);
  return {kept / "hand.grasps", kept / "hand.mapping", folder / "scheme.toml", made_for};
}

}  // namespace prehend::mapping
