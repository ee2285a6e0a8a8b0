#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/model/catalogue.hpp"
#include "common/model/scene.hpp"
#include "services/cli/service/carry_judge.hpp"

namespace prehend::cli {

/// Robot hands, each a name or a folder; the left one may be the mirror image of a right one.
struct TwoHands {
  std::string left, right;
};

/// Of «left:HAND» and «right:HAND». A left hand that is none, by its name, is the mirror image of
/// that hand.
Expected<TwoHands> read_hands(const std::vector<std::string>& entries);

/// What two hands do together, and the person who shows it.
struct CarrySetting {
  model::CatalogueObject object;  // that is carried: no catalogue has it
  model::Scene scene;
};

/// Draws a crate that no hand holds alone, or a tube on which two hands find room, and where it
/// stands. right: the hand on which the person presses, and whose mirror image the other one is.
Expected<CarrySetting> make_carry_setting(CarryTask task, std::uint64_t seed,
                                          const std::string& right);

/// lab.catalogue and lab.scene of it; the folders must exist.
Expected<void> write_carry_setting(const CarrySetting& setting,
                                   const std::filesystem::path& catalogue,
                                   const std::filesystem::path& scene);

}  // namespace prehend::cli
