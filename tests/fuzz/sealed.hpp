#pragma once

#include "tests/fuzz/fuzz.hpp"

namespace prehend::fuzz {

/// Damages a sealed file (see proto/sealed_file.hpp): as it lies there, which its seal must tell,
/// or what is in it, sealed again as a foreign program might, which the reader must tell.
std::string mutate_sealed(Random& random, std::string_view kind, std::string file);

/// Throws if the file is not the very one that its content would be sealed to: what is accepted
/// must be that.
void require_intact(const std::string& file, std::string_view kind);

}  // namespace prehend::fuzz
