#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/base/error.hpp"
#include "common/recording/types/type.hpp"

/// The part of OMG IDL 4.2 that Prehend's contract uses, and what others commonly use of it:
/// modules, structures, enumerations, type definitions, integer constants, (bounded) strings and
/// sequences, arrays, annotations. Unions, maps, bit masks and inheritance are refused.
namespace prehend::recording::types {

/// Adds the types of a text without preprocessor lines. `origin` stands in errors.
Expected<void> parse_idl(std::string_view text, const std::string& origin, Library& library);

/// The types of all .idl files in a folder, which may include each other.
Expected<Library> load_idl(const std::filesystem::path& folder);

/// The contract of this lab: share/prehend/idl.
Expected<Library> load_contract();

}  // namespace prehend::recording::types
