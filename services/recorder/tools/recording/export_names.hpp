#pragma once

#include <map>
#include <string>
#include <utility>

#include "common/recording/mcap/reader.hpp"

namespace prehend::recorder {

/// A table: a topic, and one type of it as it is described, since another one has other columns.
using TableKey = std::pair<std::string, std::string>;

/// The table that messages of this channel belong in.
TableKey table_of(const recording::mcap::Channel& channel,
                  const recording::mcap::Contents& contents);

/// The name of each table's file, without its ending: the topic without a leading «/», with «-» for
/// the others and for whatever may trouble a file system. Where several tables would have the same
/// one, or it would be too long, a check sum of topic and type stands behind it, so the names are
/// the same every time.
std::map<TableKey, std::string> export_names(const recording::mcap::Contents& contents);

}  // namespace prehend::recorder
