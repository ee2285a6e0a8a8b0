#pragma once

#include <cstdint>
#include <vector>

#include "common/model/catalogue.hpp"

namespace prehend::recognition {

/// Things that no model knows, of sizes and patterns like the objects'. Another seed, other things.
std::vector<model::CatalogueObject> strangers(int count, std::uint64_t seed);

/// An object that nobody has a picture of: colours and a pattern drawn from its name.
model::CatalogueObject imagined(const std::string& name, const model::Shape& shape, double mass);

}  // namespace prehend::recognition
