#pragma once

#include "command.h"

#include <jobs/exports/export_map.h>

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace hshfit::cli {

/// The answer for an exported map of materials, and its text.
nlohmann::ordered_json mapDocument(const jobs::ExportedMap& exported, const std::string& folder);
std::string mapDocumentText(const nlohmann::ordered_json& document);
bool isMapDocument(const nlohmann::ordered_json& document);

}  // namespace hshfit::cli
