#pragma once

#include <filesystem>
#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <string_view>

#include "common/base/error.hpp"
#include "common/recording/mcap/record.hpp"

/// Records as JSON, in the form of the MCAP project's conformance tests: {"type": T, "fields":
/// [[name, value], ...]} in order of the names; whole numbers are strings, bytes are lists of such.
namespace prehend::recorder {

/// Chunks and message indexes, which that form does not have, and unknown records are null.
nlohmann::ordered_json to_json(const recording::mcap::Record& record);

/// Prints {"records": [...]} with all records of a file, those inside chunks in place of their
/// chunk. What was printed before a failure is closed, so it is JSON in any case.
Expected<void> print_records(const std::filesystem::path& file, std::ostream& out);

/// Makes a file of such a document: of its header, schemas, channels, messages, attachments and
/// metadata up to its DataEnd; the rest follows from them. `meta.variant.features` says which
/// optional parts it gets (ch, mx, st, rsh, rch, ax, mdx, chx, sum, pad); without it, all but pad.
/// There is one chunk, not compressed, and CRCs, so that the same document gives the same bytes as
/// the conformance tests' own writer.
Expected<void> write_records(std::string_view document, const std::filesystem::path& file);

}  // namespace prehend::recorder
