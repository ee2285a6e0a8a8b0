#pragma once

#include <functional>
#include <string>

#include "common/base/random.hpp"

namespace prehend::fuzz {

/// Bits flipped, pieces cut out, doubled, moved or overwritten: for any format.
std::string mutate_bytes(Random& random, std::string bytes);

/// One number of a text becomes another, or nan, inf, something huge, tiny, negative, or nothing.
std::string mutate_number(Random& random, std::string text);

/// An element of XML is deleted, doubled, moved or renamed, or an attribute taken away or given the
/// value of another.
std::string mutate_xml(Random& random, std::string text);

/// A line is deleted, doubled, moved, or loses what stands behind its equals sign.
std::string mutate_lines(Random& random, std::string text);

/// One to three of these: bytes, numbers (twice as often), and as often what changes the structure
/// of this kind of text, as mutate_xml or mutate_lines does.
std::string mutate_text(Random& random, std::string text,
                        const std::function<std::string(Random&, std::string)>& mutate_structure);

}  // namespace prehend::fuzz
